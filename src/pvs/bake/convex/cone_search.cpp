#include "src/pvs/bake/convex/cone_search.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "src/hierarchy/wide_hierarchy.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/pvs/bake/convex/cone_search.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef SIGHTLINE_CONE_SEARCH_ONCE
#define SIGHTLINE_CONE_SEARCH_ONCE
namespace sightline::pvs {
constexpr std::size_t kConeLanes = 16;  // at most
}  // namespace sightline::pvs
#endif

HWY_BEFORE_NAMESPACE();
namespace sightline::pvs {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Where along the lines, 0 to 1, single precision may be wrong by less than this.
constexpr float kAlongCone = 1e-6f;

using Lanes = hn::CappedTag<float, kConeLanes>;
constexpr Lanes kLanes{};

// The lanes, out of `met`, of boxes that the cone meets.
HWY_INLINE hn::Mask<Lanes> meets(const BoxLanes& boxes, std::size_t first, const Cone& cone,
                                 hn::Mask<Lanes> met) {
  auto begin = hn::Zero(kLanes), end = hn::Set(kLanes, 1.0f + kAlongCone);
  for (std::size_t a = 0; a < 3; ++a) {
    const Cone::Axis& axis = cone.axes[a];
    const auto min = hn::LoadU(kLanes, boxes.min[a].data() + first);
    const auto max = hn::LoadU(kLanes, boxes.max[a].data() + first);
    const auto far = hn::Mul(hn::Sub(min, hn::Set(kLanes, axis.low)), hn::Set(kLanes, axis.inverse_far));
    const auto near = hn::Mul(hn::Sub(max, hn::Set(kLanes, axis.high)), hn::Set(kLanes, axis.inverse_near));
    if (axis.inverse_far > 0.0f) {
      begin = hn::Max(begin, far);
    } else {
      end = hn::Min(end, far);
    }
    if (axis.inverse_near > 0.0f) {
      end = hn::Min(end, near);
    } else {
      begin = hn::Max(begin, near);
    }
  }
  return hn::And(met, hn::Le(begin, hn::Add(end, hn::Set(kLanes, kAlongCone))));
}

// Writes the places of those of the boxes first ... first + count - 1 that all cones meet, and returns how
// many they are.
std::size_t findMet(const BoxLanes& boxes, std::span<const Cone> cones, std::size_t first, std::size_t count,
                    std::uint32_t* places) {
  std::size_t found = 0;
  for (std::size_t i = 0; i < count; i += hn::Lanes(kLanes)) {
    auto met = hn::FirstN(kLanes, count - i);
    for (const Cone& cone : cones) {
      met = meets(boxes, first + i, cone, met);
      if (hn::AllFalse(kLanes, met)) {
        break;
      }
    }
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(kLanes, met, bytes);
    for (auto bits = static_cast<std::uint32_t>(bytes[0] | bytes[1] << 8); bits != 0; bits &= bits - 1) {
      places[found++] =
          static_cast<std::uint32_t>(first + i) + static_cast<std::uint32_t>(std::countr_zero(bits));
    }
  }
  return found;
}

}  // namespace HWY_NAMESPACE
}  // namespace sightline::pvs
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::pvs {
namespace {

HWY_EXPORT(findMet);

constexpr std::uint32_t kNodeBit = 1u << 31;
// Single precision loses less than this of the difference of two coordinates, in units of their bound.
constexpr double kRounding = 0x1p-21;
// Below this, the inverse is a normal number of single precision.
constexpr double kFarthestInSingles = 0x1p126;

float inverseOf(double end, float if_zero) {
  return std::abs(end) > 1e-25 ? 1.0f / static_cast<float>(end) : if_zero;
}

}  // namespace

Cone::Cone(const CellBox& from, const CellBox& to, double margin, double magnitude) {
  const double slack = margin + kRounding * magnitude;
  for (int a = 0; a < 3; ++a) {
    const double far = to.max[a] - from.max[a], near = to.min[a] - from.min[a];
    // Where an end stays where it is along an axis, all of the cone is before what lies beyond it.
    Axis& axis = axes[static_cast<std::size_t>(a)];
    // Beyond the range of single precision, the axis bounds nothing.
    if (!(std::abs(far) < kFarthestInSingles && std::abs(near) < kFarthestInSingles)) {
      constexpr float kMost = std::numeric_limits<float>::max();
      axis = {.low = kMost, .high = -kMost, .inverse_far = 1.0f, .inverse_near = -1.0f};
      continue;
    }
    axis.low = static_cast<float>(from.max[a] + slack);
    axis.high = static_cast<float>(from.min[a] - slack);
    axis.inverse_far = inverseOf(far, 1e25f);
    axis.inverse_near = far == near && axis.inverse_far != 1e25f ? axis.inverse_far : inverseOf(near, -1e25f);
  }
}

void BoxLanes::clear() {
  for (std::size_t a = 0; a < 3; ++a) {
    min[a].clear();
    max[a].clear();
  }
  number.clear();
}

void BoxLanes::add(const Box& box, std::uint32_t its_number) {
  for (std::size_t a = 0; a < 3; ++a) {
    min[a].push_back(box.min[static_cast<int>(a)]);
    max[a].push_back(box.max[static_cast<int>(a)]);
  }
  number.push_back(its_number);
}

void BoxLanes::add(const BoxLanes& from, std::span<const std::uint32_t> places) {
  const auto append = [places](auto& to, const auto& values) {
    const std::size_t before = to.size();
    to.resize(before + places.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
      to[before + i] = values[places[i]];
    }
  };
  for (std::size_t a = 0; a < 3; ++a) {
    append(min[a], from.min[a]);
    append(max[a], from.max[a]);
  }
  append(number, from.number);
}

void BoxLanes::pad() {
  for (std::size_t a = 0; a < 3; ++a) {
    min[a].resize(size() + kConeLanes);
    max[a].resize(size() + kConeLanes);
  }
}

void placesMet(const BoxLanes& boxes, std::span<const Cone> cones, std::vector<std::uint32_t>& places) {
  placesMet(boxes, 0, boxes.size(), cones, places);
}

void placesMet(const BoxLanes& boxes, std::size_t first, std::size_t count, std::span<const Cone> cones,
               std::vector<std::uint32_t>& places) {
  places.resize(count + kConeLanes);
  places.resize(HWY_DYNAMIC_DISPATCH(findMet)(boxes, cones, first, count, places.data()));
}

ConeTree::ConeTree(std::span<const Box> boxes, std::span<const std::uint32_t> numbers) {
  const hierarchy::WideHierarchy wide = hierarchy::collapse(buildHierarchy(boxes, {}), boxes);
  std::vector<std::uint32_t> of_child(wide.boxes.size());
  for (const hierarchy::WideNode& node : wide.nodes) {
    nodes_.push_back({node.first_child, node.child_end - node.first_child});
    for (std::uint32_t i = node.first_child; i < node.child_end; ++i) {
      const std::uint32_t place = i - node.first_child;
      of_child[i] =
          place < node.node_count ? (node.first_node + place) | kNodeBit : numbers[wide.object[i].value];
    }
  }
  for (std::size_t i = 0; i < of_child.size(); ++i) {
    children_.add(wide.boxes[i], of_child[i]);
  }
  children_.pad();
}

bool ConeTree::find(std::span<const Cone> cones, std::size_t most, std::vector<std::uint32_t>& found) const {
  found.clear();
  return nodes_.empty() || findBelow(cones, 0, most, found);
}

bool ConeTree::findBelow(std::span<const Cone> cones, std::uint32_t number, std::size_t most,
                         std::vector<std::uint32_t>& found) const {
  const Node& node = nodes_[number];
  for (std::uint32_t i = 0; i < node.child_count; i += kConeLanes) {
    std::array<std::uint32_t, 2 * kConeLanes> places;
    const std::size_t count =
        HWY_DYNAMIC_DISPATCH(findMet)(children_, cones, node.first_child + i,
                                      std::min<std::size_t>(node.child_count - i, kConeLanes), places.data());
    for (const std::uint32_t place : std::span(places).first(count)) {
      const std::uint32_t child = children_.number[place];
      if ((child & kNodeBit) == 0) {
        found.push_back(place);
      } else if (!findBelow(cones, child & ~kNodeBit, most, found)) {
        return false;
      }
    }
  }
  return found.size() <= most;
}

}  // namespace sightline::pvs
#endif
