#include "src/pvs/bake/convex/cell_candidates.h"

#include <algorithm>
#include <array>
#include <bit>

namespace sightline::pvs {
namespace {

// If more occluders than this may hide something below a node, they are not listed for it.
constexpr std::size_t kMostAbove = 1u << 16;

// True only if the occluder is a polygon that is separated from no region within the cell, because no point
// of the cell is clearly in front of it.
bool looksAway(const ConvexOccluders& all, const ConvexOccluder& occluder, const CellBox& cell) {
  if (occluder.body || occluder.double_sided) {
    return false;
  }
  const Plane& plane = all.facesOf(occluder).front().plane;
  const Vec3d highest{plane.normal.x > 0.0 ? cell.max.x : cell.min.x,
                      plane.normal.y > 0.0 ? cell.max.y : cell.min.y,
                      plane.normal.z > 0.0 ? cell.max.z : cell.min.z};
  return plane.evaluate(highest) <= 0.5 * occluder.margin;
}

}  // namespace

bool CellCandidates::make(const CellBox& cell, const ObjectMask& hidden, const CellCandidates* around,
                          std::size_t most) {
  groups_.clear();
  lists_.clear();
  const Visit visit{cell, &hidden, most};
  const bool done = around != nullptr ? narrow(visit, *around)
                                      : scene_->shadow_tree.nodes().empty() || search(visit, 0, {}, 0);
  if (!done) {
    groups_.clear();
    lists_.clear();
  }
  lists_.pad();
  return done;
}

bool CellCandidates::narrow(const Visit& visit, const CellCandidates& around) {
  return std::ranges::all_of(around.groups(), [&](const Group& group) {
    return addGroup(visit, group.first, leavesOf(visit, group.first, group.leaves),
                    around.occludersOf(group));
  });
}

bool CellCandidates::search(const Visit& visit, std::uint32_t node, LanesRange above, std::size_t depth) {
  const ShadowTree& tree = scene_->shadow_tree;
  const ShadowTree::Node& inner = tree.nodes()[node];
  if (!tree.mayHoldHidden(node) || visit.hidden->containsAll(inner.objects)) {
    return true;
  }
  if (above_.size() <= depth) {
    above_.emplace_back();
  }
  const BoxLanes* boxes = nullptr;
  const auto corners_of = [&](std::uint32_t i) { return tree.cornersBelow(node, i); };
  if (findPlaces(visit, corners_of, above, kMostAbove, boxes)) {
    BoxLanes& below = above_[depth];
    below.clear();
    below.add(*boxes, places_);
    below.pad();
    above = {&below, 0, below.size()};
  }
  if (above.boxes != nullptr && above.count == 0) {
    return true;
  }
  for (std::uint32_t i = 0; i < inner.child_count; i += ShadowTree::kGroup) {
    if (!searchGroup(visit, inner.first_child + i, std::min(inner.child_count - i, ShadowTree::kGroup), above,
                     depth)) {
      return false;
    }
  }
  return true;
}

bool CellCandidates::searchGroup(const Visit& visit, std::uint32_t first, std::uint32_t count,
                                 LanesRange above, std::size_t depth) {
  const std::span<const ShadowTree::Node> nodes = scene_->shadow_tree.nodes();
  std::uint32_t leaves = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    leaves |= nodes[first + i].child_count == 0 ? 1u << i : 0u;
  }
  if (!addGroup(visit, first, leavesOf(visit, first, leaves), above)) {
    return false;
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    if (nodes[first + i].child_count > 0 && !search(visit, first + i, above, depth + 1)) {
      return false;
    }
  }
  return true;
}

std::uint32_t CellCandidates::leavesOf(const Visit& visit, std::uint32_t first, std::uint32_t some) const {
  const ShadowTree& tree = scene_->shadow_tree;
  std::uint32_t leaves = 0;
  for (; some != 0; some &= some - 1) {
    const auto i = static_cast<std::uint32_t>(std::countr_zero(some));
    const bool counts =
        tree.mayBeHidden(first + i) && !visit.hidden->contains(tree.nodes()[first + i].objects.begin);
    leaves |= counts ? 1u << i : 0u;
  }
  return leaves;
}

bool CellCandidates::addGroup(const Visit& visit, std::uint32_t first, std::uint32_t leaves,
                              LanesRange above) {
  if (leaves == 0) {
    return true;
  }
  const ShadowTree& tree = scene_->shadow_tree;
  const auto corners_of = [&](std::uint32_t i) {
    CellBox bounds = tree.cornersBelow(first + static_cast<std::uint32_t>(std::countr_zero(leaves)), i);
    for (std::uint32_t left = leaves & (leaves - 1); left != 0; left &= left - 1) {
      const CellBox corner = tree.cornersBelow(first + static_cast<std::uint32_t>(std::countr_zero(left)), i);
      bounds = {min(bounds.min, corner.min), max(bounds.max, corner.max)};
    }
    return bounds;
  };
  const BoxLanes* boxes = nullptr;
  if (!findPlaces(visit, corners_of, above, visit.most - lists_.size(), boxes)) {
    return false;
  }
  if (!places_.empty()) {
    const std::size_t begin = lists_.size();
    lists_.add(*boxes, places_);
    groups_.push_back({first, leaves, begin, lists_.size()});
  }
  return true;
}

template <typename CornersOf>
bool CellCandidates::findPlaces(const Visit& visit, const CornersOf& corners_of, LanesRange above,
                                std::size_t most, const BoxLanes*& boxes) {
  const auto hull = [&](std::uint32_t i) { return scene_->hullOf(visit.cell, corners_of(i)); };
  // No two of these corners are on one edge of the box: few boxes meet the hulls of all of them.
  const std::array<Cone, 4> hulls{hull(0), hull(3), hull(5), hull(6)};
  if (above.boxes != nullptr) {
    boxes = above.boxes;
    placesMet(*boxes, above.first, above.count, hulls, places_);
  } else {
    const ConeTree& all = scene_->occludersInCones(scene_->settings.max_depth);
    boxes = &all.boxes();
    if (!all.find(hulls, most, places_)) {
      return false;
    }
  }
  std::erase_if(places_, [&](std::uint32_t place) {
    const std::uint32_t occluder = boxes->number[place];
    return visit.hidden->contains(scene_->position_of_occluder[occluder]) ||
           looksAway(scene_->occluders, scene_->occluders[occluder], visit.cell);
  });
  return places_.size() <= most;
}

}  // namespace sightline::pvs
