#include "src/occlusion/planes/active_occluders.h"

#include <algorithm>
#include <cmath>

#include "src/scene/usable_view.h"

namespace sightline::occlusion {
namespace {

// The inset is a power of two, so that it seldom changes while the eye moves, and at least this times the
// occluder's reach. See docs/conservative.md.
constexpr double kMinInset = 0x1p-28;

// Finds the plane through the eye and the line where the near plane cuts the occluder. False: there is none,
// or more than one, as where an occluder that is flat up to its slack is nearly parallel to the near plane.
bool cutAtNear(const Eye& eye, const OccluderSet& set, ActiveOccluder& occluder) {
  Vec3d leaving, entering;
  bool leaves = false, enters = false;
  const std::uint32_t n = set[occluder.seen.id].vertex_count;
  for (std::uint32_t side = 0; side < n; ++side) {
    const Outline edge = outlineOf(eye, set, occluder.seen, side);
    const double a = dot(eye.forward, edge.from) - occluder.seen.clip_depth;
    const double b = dot(eye.forward, edge.to) - occluder.seen.clip_depth;
    if ((a >= 0.0) == (b >= 0.0)) {
      continue;
    }
    if (a >= 0.0 ? leaves : enters) {
      return false;
    }
    const Vec3d crossing = edge.from + (edge.to - edge.from) * (a / (a - b));
    (a >= 0.0 ? leaving : entering) = crossing;
    (a >= 0.0 ? leaves : enters) = true;
  }
  double sine = 0.0;
  occluder.near_cut = eye.shadowPlane(leaving, entering, sine);
  return leaves && enters && sine > kGrazingSine;
}

// Nothing where the occluder cannot be used from this eye.
std::optional<ActiveOccluder> makeActive(const Eye& eye, const OccluderSet& set, OccluderId id) {
  const std::optional<EyeOccluder> seen = seeOccluder(eye, set, id);
  if (!seen) {
    return std::nullopt;
  }
  const Occluder& occluder = set[id];
  ActiveOccluder active;
  active.seen = *seen;
  int exponent = 0;
  std::frexp(std::max(seen->inset, kMinInset * seen->reach), &exponent);
  active.inset_exponent = static_cast<std::int16_t>(exponent);
  active.inset = std::ldexp(1.0, exponent);
  if (!(active.inset * active.inset < 0.01 * occluder.area)) {
    return std::nullopt;
  }
  active.origin = Vec3d(set.vertices[occluder.first_vertex]);
  active.edge_count = occluder.vertex_count;
  active.near_clipped = seen->nearest < seen->clip_depth;
  // EyePlaneTest::failing needs a bit for the cut.
  if (active.near_clipped && (active.edge_count > 63 || !cutAtNear(eye, set, active))) {
    return std::nullopt;
  }
  return active;
}

// Appends the occluder's edges, drawn in, counter-clockwise from its front: Occluder::vertex_count of them.
void appendInsetEdges(const OccluderSet& set, const ActiveOccluder& active, std::vector<InsetEdge>& edges) {
  const Occluder& occluder = set[active.seen.id];
  const auto corner = [&](std::uint32_t i) {
    return Vec3d(set.vertices[occluder.first_vertex + i % occluder.vertex_count]) - active.origin;
  };
  for (std::uint32_t e = 0; e < occluder.vertex_count; ++e) {
    const Vec3d direction = normalized(corner(e + 1) - corner(e));
    const Vec3d inwards = cross(occluder.plane.normal, direction);
    edges.push_back({corner(e) + inwards * active.inset, direction});
  }
}

// Makes the occluder's planes through the eye and appends them, four to a quad. edges: its own.
EyeShape makeEyeShape(const Eye& eye, const ActiveOccluder& active, std::span<const InsetEdge> edges,
                      std::vector<EyeQuad>& quads) {
  const EyeOccluder& seen = active.seen;
  EyeShape shape{seen.support.normal, seen.support.offset, active.inset, seen.reach,
                 static_cast<std::uint32_t>(quads.size())};
  const auto add = [&](const Plane& plane) {
    const std::uint32_t lane = shape.plane_count++ % 4;
    if (lane == 0) {
      quads.emplace_back();
    }
    quads.back().x[lane] = plane.normal.x;
    quads.back().y[lane] = plane.normal.y;
    quads.back().z[lane] = plane.normal.z;
    quads.back().offset[lane] = plane.offset;
  };
  for (const InsetEdge& edge : edges) {
    // An eye behind the occluder's front sees its edges run the other way round.
    const Vec3d along = seen.flipped ? -edge.direction : edge.direction;
    const Vec3d from = edge.point + (active.origin - eye.position);
    double sine = 0.0;
    add(eye.shadowPlane(from, from + along * length(from), sine));
  }
  if (active.near_clipped) {
    add(active.near_cut);
  }
  return shape;
}

}  // namespace

void ActiveOccluders::takeSources(std::span<const ChosenOccluders> sets) {
  for (const std::uint32_t slot : taken_slots_) {
    number_of_[slot] = kNone;
  }
  taken_slots_.clear();
  sources_.clear();
  std::size_t slots = 0;
  for (const ChosenOccluders& part : sets) {
    sources_.push_back({part.set, static_cast<std::uint32_t>(slots)});
    slots += part.set->occluders.size();
  }
  number_of_.resize(std::max(number_of_.size(), slots), kNone);
}

void ActiveOccluders::build(const View& given, std::span<const ChosenOccluders> sets) {
  View view = given;
  usable_view_ = scene::makeUsable(view) == nullptr;
  eye_ = Eye(view);
  takeSources(sets);
  occluders_.clear();
  inset_edges_.clear();
  shapes_.clear();
  quads_.clear();
  lists_.clear();
  used_.clear();
  for (std::uint32_t set = 0; set < sets.size(); ++set) {
    add(set, sets[set].chosen);
  }
  all_ = {0, endOfLists()};
  built_count_ = size();
  for (const ActiveOccluder& occluder : occluders_) {
    if (occluder.set == 0) {
      used_.push_back(occluder.seen.id);
    }
  }
  stats_.occluders = built_count_;
  stats_.unusable = static_cast<std::uint32_t>(taken_slots_.size()) - built_count_;
}

OccluderList ActiveOccluders::add(std::uint32_t set, std::span<const OccluderId> ids) {
  const std::uint32_t first = endOfLists();
  for (const OccluderId id : ids) {
    const bool known =
        usable_view_ && set < sources_.size() && id.value < sources_[set].set->occluders.size();
    const std::uint32_t number = known ? activate(set, id) : kNone;
    if (number != kNone) {
      append(number);
    }
  }
  const auto begin = lists_.begin() + static_cast<std::ptrdiff_t>(first);
  std::sort(begin, lists_.end(), [this](std::uint32_t a, std::uint32_t b) {
    return occluders_[a].seen.id < occluders_[b].seen.id;
  });
  lists_.erase(std::unique(begin, lists_.end()), lists_.end());
  return {first, endOfLists() - first};
}

// Returns the occluder's number; kNone where it cannot be used from here.
std::uint32_t ActiveOccluders::activate(std::uint32_t set_index, OccluderId id) {
  const OccluderSet& set = *sources_[set_index].set;
  const std::uint32_t slot = sources_[set_index].first_slot + id.value;
  if (number_of_[slot] == kNone) {
    taken_slots_.push_back(slot);
    number_of_[slot] = kUnusable;
    if (const std::optional<ActiveOccluder> made = makeActive(eye_, set, id)) {
      number_of_[slot] = size();
      ActiveOccluder& active = occluders_.emplace_back(*made);
      active.set = set_index;
      active.first_edge = static_cast<std::uint32_t>(inset_edges_.size());
      appendInsetEdges(set, active, inset_edges_);
      shapes_.push_back(makeEyeShape(eye_, active, edgesOf(active), quads_));
    }
  }
  return number_of_[slot] == kUnusable ? kNone : number_of_[slot];
}

std::span<const InsetEdge> ActiveOccluders::edgesOf(const ActiveOccluder& occluder) const {
  return std::span(inset_edges_).subspan(occluder.first_edge, occluder.edge_count);
}

std::uint32_t ActiveOccluders::find(std::uint32_t set, OccluderId id) const {
  const std::uint32_t number = number_of_[sources_[set].first_slot + id.value];
  return number == kUnusable ? kNone : number;
}

EyePlaneTest ActiveOccluders::test(std::uint32_t number, const Box& box) const {
  EyePlaneTest test;
  testAgainstEyePlanes(shapes_, quads_, {&number, 1}, EyeBox::of(box, eye_.position), {&test, 1});
  return test;
}

std::uint32_t ActiveOccluders::testEach(OccluderList list, const Box& box,
                                        std::span<EyePlaneTest> tests) const {
  const std::span<const std::uint32_t> numbers = std::span(lists_).subspan(list.first, list.count);
  return static_cast<std::uint32_t>(
      testAgainstEyePlanes(shapes_, quads_, numbers, EyeBox::of(box, eye_.position), tests));
}

}  // namespace sightline::occlusion
