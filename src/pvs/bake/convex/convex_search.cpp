#include "src/pvs/bake/convex/convex_search.h"

#include <algorithm>
#include <bit>

namespace sightline::pvs {
namespace {

// If no more occluders than this are in the cone to a node, they are listed for what is below it.
constexpr std::size_t kMostCandidates = 8192;
// A list of no more than this is used for all that is below, without leaving out more of it.
constexpr std::size_t kFewCandidates = 8;
// In lists of no more than this, occluders that are not separated from the region are left out at once.
constexpr std::size_t kFewToSeparate = 128;

// By point: the number of the box corner that lies on the point's side of the region's middle.
void findSides(std::span<const Vec3d> corners, std::vector<std::uint32_t>& sides) {
  const Vec3d middle = pvs::boundsOf(corners).centre();
  sides.clear();
  for (const Vec3d& corner : corners) {
    std::uint32_t side = 0;
    for (int axis = 0; axis < 3; ++axis) {
      side |= corner[axis] > middle[axis] ? 1u << axis : 0u;
    }
    sides.push_back(side);
  }
}

}  // namespace

ConvexSearch::ConvexSearch(const BakeScene& scene) : scene_(scene) {
  for (Shadows& shadows : shadows_) {
    shadows.of_corner.resize(kMaxCorners);
  }
  separated_.resize(scene.occluders.size());
  nothing_.reset(static_cast<std::uint32_t>(scene.boxes.objects.size()));
}

bool ConvexSearch::start(std::span<const Vec3d> corners, const OccluderChoice& choice,
                         const ObjectMask& known) {
  corners_ = corners;
  choice_ = &choice;
  known_ = &known;
  enough_ = std::nullopt;
  hidden_triangles_ = seen_triangles_ = 0;
  found_.clear();
  recent_ = 0;
  ++question_;
  if (corners.empty() || corners.size() > kMaxCorners || scene_.shadow_tree.nodes().empty()) {
    return false;
  }
  findSides(corners, side_of_);
  return true;
}

std::span<const ConvexSearch::Found> ConvexSearch::hiddenFrom(std::span<const Vec3d> corners,
                                                              const OccluderChoice& choice,
                                                              const ObjectMask& known) {
  if (start(corners, choice, known)) {
    visit(0, 1, {}, 0);
  }
  return found_;
}

std::span<const ConvexSearch::Found> ConvexSearch::hiddenFrom(std::span<const Vec3d> corners,
                                                              const OccluderChoice& choice,
                                                              const ObjectMask& known, const ObjectMask& seen,
                                                              const CellCandidates& lists) {
  if (!start(corners, choice, known)) {
    return found_;
  }
  const std::span<const ShadowTree::Node> nodes = scene_.shadow_tree.nodes();
  for (const CellCandidates::Group& group : lists.groups()) {
    std::uint32_t left = 0;
    for (std::uint32_t some = group.leaves; some != 0; some &= some - 1) {
      const auto i = static_cast<std::uint32_t>(std::countr_zero(some));
      const std::uint32_t object = nodes[group.first + i].objects.begin;
      left |= known.contains(object) || seen.contains(object) ? 0u : 1u << i;
    }
    if (left != 0) {
      hideGroup(group.first, static_cast<std::uint32_t>(std::bit_width(left)), left,
                {lists.occludersOf(group), false});
    }
  }
  return found_;
}

ConvexSearch::Bounds ConvexSearch::trianglesSeenFrom(const Vec3d& eye, const OccluderChoice& choice,
                                                     double enough) {
  const bool any = start(std::span(&eye, 1), choice, nothing_);
  enough_ = enough;
  if (any) {
    visit(0, 1, {}, 0);
  }
  return {seen_triangles_, scene_.triangles.all() - hidden_triangles_};
}

bool ConvexSearch::done() const {
  return enough_ && (static_cast<double>(seen_triangles_) >= *enough_ ||
                     static_cast<double>(scene_.triangles.all() - hidden_triangles_) < *enough_);
}

bool ConvexSearch::hides(std::span<const Vec3d> corners, const OccluderChoice& choice,
                         const ObjectMask& known, std::uint32_t position) {
  if (!start(corners, choice, known)) {
    return false;
  }
  const std::uint32_t leaf = scene_.shadow_tree.leafAt(position);
  return hideByAny(leaf, {}, leaf, 1, 1) != 0;
}

bool ConvexSearch::visit(std::uint32_t first, std::uint32_t count, Candidates candidates, std::size_t depth) {
  for (std::uint32_t i = 0; i < count; i += ShadowTree::kGroup) {
    if (!visitGroup(first + i, std::min(count - i, ShadowTree::kGroup), candidates, depth)) {
      return false;
    }
  }
  return true;
}

bool ConvexSearch::visitGroup(std::uint32_t first, std::uint32_t count, Candidates candidates,
                              std::size_t depth) {
  const std::span<const ShadowTree::Node> nodes = scene_.shadow_tree.nodes();
  std::uint32_t left = 0;  // bits of the nodes that nothing has been found to hide
  for (std::uint32_t i = 0; i < count; ++i) {
    left |= known_->containsAll(nodes[first + i].objects) ? 0u : 1u << i;
  }
  std::uint32_t seen = left & ~hideGroup(first, count, left, candidates);
  for (; seen != 0 && !done(); seen &= seen - 1) {
    const std::uint32_t node = first + static_cast<std::uint32_t>(std::countr_zero(seen));
    if (nodes[node].child_count == 0) {
      seen_triangles_ += scene_.triangles.of({&nodes[node].objects, 1});
    } else if (!visitBelow(node, candidates, depth)) {
      return false;
    }
  }
  return !done();
}

std::uint32_t ConvexSearch::hideGroup(std::uint32_t first, std::uint32_t count, std::uint32_t left,
                                      Candidates candidates) {
  const std::uint32_t all = left;
  left &= ~hideByRecent(first, count, left);
  std::uint32_t seen = 0;
  while ((left & ~seen) != 0) {
    const auto i = static_cast<std::uint32_t>(std::countr_zero(left & ~seen));
    const std::uint32_t hidden = hideByAny(first + i, candidates, first, count, left);
    left &= ~hidden;
    seen |= hidden == 0 ? 1u << i : 0u;
  }
  return all & ~left;
}

bool ConvexSearch::visitBelow(std::uint32_t node, Candidates candidates, std::size_t depth) {
  const ShadowTree::Node& inner = scene_.shadow_tree.nodes()[node];
  const bool any = scene_.shadow_tree.mayHoldHidden(node);
  candidates = any ? candidatesBelow(node, candidates, depth) : Candidates();
  if (!any || (candidates.listed() && candidates.list.count == 0)) {
    seen_triangles_ += scene_.triangles.of({&inner.objects, 1});
    return !done();
  }
  return visit(inner.first_child, inner.child_count, candidates, depth + 1);
}

template <typename BoxOf>
std::array<Cone, 4> ConvexSearch::conesTo(const BoxOf& box_of) const {
  const auto cone = [&](std::size_t i) {
    constexpr std::array<std::uint32_t, 4> kFromAPoint{0, 3, 5, 6};
    const std::size_t corner = std::min(i, corners_.size() - 1);
    return scene_.coneTo(box_of(corners_.size() == 1 ? kFromAPoint[i] : side_of_[corner]), corners_[corner]);
  };
  return {cone(0), cone(1), cone(2), cone(3)};
}

ConvexSearch::Candidates ConvexSearch::candidatesBelow(std::uint32_t node, Candidates above,
                                                       std::size_t depth) {
  if (above.listed() && above.list.count <= kFewCandidates) {
    return above;
  }
  if (candidates_.size() <= depth) {
    candidates_.emplace_back();
  }
  BoxLanes& below = candidates_[depth];
  const auto cones = conesTo([&](std::uint32_t i) { return scene_.shadow_tree.cornersBelow(node, i); });
  below.clear();
  if (above.listed()) {
    const BoxLanes& boxes = *above.list.boxes;
    placesMet(boxes, above.list.first, above.list.count, cones, places_);
    if (above.list.count <= kFewToSeparate) {
      std::erase_if(places_, [&](std::uint32_t place) { return !isSeparated(boxes.number[place]); });
    }
    below.add(boxes, places_);
  } else {
    const ConeTree& all = scene_.occludersInCones(choice_->level);
    if (!all.find(cones, kMostCandidates, places_)) {
      return {};
    }
    std::erase_if(places_, [&](std::uint32_t place) {
      return !counts(all.boxes().number[place], all.boxes().boxAt(place));
    });
    below.add(all.boxes(), places_);
  }
  below.pad();
  return {{&below, 0, below.size()}, true};
}

std::uint32_t ConvexSearch::hideByRecent(std::uint32_t first, std::uint32_t count, std::uint32_t left) {
  std::uint32_t all = 0;
  for (std::size_t i = 0; i < recent_ && (left & ~all) != 0; ++i) {
    const std::uint32_t hidden =
        scene_.shadow_tree.hidden(std::span(shadows_[i].of_corner).first(corners_.size()), first, count) &
        left & ~all;
    if (hidden != 0) {
      report(shadows_[i].occluder, first, hidden);
      all |= hidden;
      std::rotate(shadows_.begin(), shadows_.begin() + static_cast<std::ptrdiff_t>(i),
                  shadows_.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    }
  }
  return all;
}

std::uint32_t ConvexSearch::hideByAny(std::uint32_t node, Candidates candidates, std::uint32_t first,
                                      std::uint32_t count, std::uint32_t left) {
  if (!scene_.shadow_tree.mayBeHidden(node)) {
    return 0;
  }
  findMet(node, candidates);
  std::sort(met_.begin(), met_.end());  // occluders are numbered from the largest on
  findLines(node);
  Shadows& shadows = shadows_.back();
  for (const std::uint32_t i : met_) {
    if (meetsLines(i) && isSeparated(i) && makeShadows(i, node, shadows)) {
      const std::span<const Shadow> of_corners = std::span(shadows.of_corner).first(corners_.size());
      const std::uint32_t hidden = scene_.shadow_tree.hidden(of_corners, first, count) & left;
      report(i, first, hidden);
      std::rotate(shadows_.begin(), shadows_.end() - 1, shadows_.end());
      recent_ = std::min(recent_ + 1, kRecent);
      return hidden;
    }
  }
  return 0;
}

void ConvexSearch::findMet(std::uint32_t node, Candidates candidates) {
  const CellBox box = scene_.shadow_tree.boxOf(node);
  const auto lines = conesTo([&](std::uint32_t i) { return CellBox{box.corner(i), box.corner(i)}; });
  const ConeTree& all = scene_.occludersInCones(choice_->level);
  const BoxLanes& boxes = candidates.listed() ? *candidates.list.boxes : all.boxes();
  if (candidates.listed()) {
    placesMet(boxes, candidates.list.first, candidates.list.count, lines, places_);
  } else {
    all.find(lines, scene_.occluders.size(), places_);
  }
  met_.clear();
  for (const std::uint32_t place : places_) {
    const std::uint32_t occluder = boxes.number[place];
    if (candidates.counted ||
        (scene_.isOfUseAt(choice_->level, occluder) && counts(occluder, boxes.boxAt(place)))) {
      met_.push_back(occluder);
    }
  }
}

bool ConvexSearch::counts(std::uint32_t occluder, const Box& bounds) const {
  return intersects(choice_->search, bounds) && !(choice_->known && intersects(*choice_->known, bounds)) &&
         !known_->contains(scene_.position_of_occluder[occluder]);
}

bool ConvexSearch::isSeparated(std::uint32_t occluder) {
  std::uint64_t& known = separated_[occluder];
  if (known >> 1 != question_) {
    const bool yes =
        separated(scene_.occluders, scene_.occluders[occluder], corners_, scene_.settings.near_distance);
    known = question_ << 1 | (yes ? 1u : 0u);
  }
  return (known & 1u) != 0;
}

void ConvexSearch::findLines(std::uint32_t node) {
  const CellBox box = scene_.shadow_tree.boxOf(node);
  lines_.clear();
  for (std::uint32_t c = 0; c < corners_.size() && !met_.empty(); ++c) {
    for (const std::uint32_t end : {side_of_[c], 7 - side_of_[c]}) {
      lines_.emplace_back(corners_[c], box.corner(end), scene_.lineMargin());
    }
  }
}

bool ConvexSearch::meetsLines(std::uint32_t occluder) const {
  const Box& bounds = scene_.occluders[occluder].bounds;
  return std::ranges::none_of(lines_, [&](const SegmentTest& line) { return line.misses(bounds); });
}

bool ConvexSearch::makeShadows(std::uint32_t occluder, std::uint32_t node, Shadows& shadows) {
  shadows.occluder = occluder;
  for (std::size_t c = 0; c < corners_.size(); ++c) {
    ++shadow_count_;
    Shadow& shadow = shadows.of_corner[c];
    if (!makeShadow(scene_.occluders, scene_.occluders[occluder], corners_[c], scene_.reach, shadow) ||
        scene_.shadow_tree.hidden({&shadow, 1}, node, 1) == 0) {
      return false;
    }
  }
  return true;
}

void ConvexSearch::report(std::uint32_t occluder, std::uint32_t first, std::uint32_t nodes) {
  for (; nodes != 0; nodes &= nodes - 1) {
    const ObjectRun& objects =
        scene_.shadow_tree.nodes()[first + static_cast<std::uint32_t>(std::countr_zero(nodes))].objects;
    found_.push_back({occluder, objects});
    hidden_triangles_ += scene_.triangles.of({&objects, 1});
  }
}

}  // namespace sightline::pvs
