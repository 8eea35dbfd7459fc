// Based on: Snyder, Lengyel. Visibility Sorting and Compositing for Image-Based Rendering. MSR-TR-97-11,
// 1997, whose sort never divides; see docs/algorithms/layers.md.

#include "sightline/layers/cycle_splitter.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <utility>

#include "src/layers/hull/hull_box.h"
#include "src/layers/pairs/part_store.h"
#include "src/layers/pairs/set_occlusion.h"
#include "src/layers/split/cycle_division.h"
#include "src/layers/split/piece_tree.h"

namespace sightline {

using namespace layers;

namespace {

constexpr std::uint32_t kLooks = 4;  // divisions that are looked at in a frame, whether they are superfluous
// Two halves in one group only make it larger. They are kept for keep_frames divided by this.
constexpr std::uint32_t kInVainShare = 4;

// An eye from which an orthographic view looks, far enough to be on its side of any plane.
Vec3d farEye(const View& view) {
  constexpr double kFar = 1e12;
  const double size = length(view.forward);
  return size > 0.0 ? view.eye - view.forward * (kFar / size) : view.eye;
}

}  // namespace

struct CycleSplitter::Impl {
  Impl(LayerSorter& of, CycleSplitSettings given) : sorter(&of), settings(std::move(given)), trees(of) {}
  ~Impl() { joinAll(); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  bool mayDivide(PartId part) const;
  std::vector<ConvexSet> setsOf(PartId part) const;
  double surfaceOfPart(PartId part) const;
  std::optional<PartShape> shapeOfPart(PartId part) const;
  CycleMember memberOf(PartId part) const;
  bool divideGroups(const View& view, std::span<const Vec3d> more_eyes, const LayerOrder& order);
  bool divideGroup(std::span<const PartId> parts, const LayerOrder& order, const SetOcclusion& occlusion,
                   std::span<const Vec3d> eyes);
  bool make(CycleDivision& division, std::span<const PartId> parts);
  bool isSolid(PartId part) const { return !settings.triangles && sorter->hullsOf(part).size() == 1; }
  bool isCrossedPair(std::span<const PartId> parts, const LayerOrder& order) const;
  bool isWaiting(std::span<const PartId> parts) const;
  void wait(std::span<const PartId> parts);
  void joinSuperfluous();
  void followParts();
  void joinAll();
  void lookAtDivisions(const View& view, std::span<const Vec3d> more_eyes, const LayerOrder& order);
  void look(std::uint32_t node, const SetOcclusion& occlusion, const LayerOrder& order);
  PartId wholeOf(PartId part) const {
    const std::uint32_t node = trees.find(part);
    return node == PieceTrees::kNone ? part : trees[node].whole;
  }

  LayerSorter* sorter;
  CycleSplitSettings settings;
  PieceTrees trees;
  std::vector<std::uint64_t> kept_whole;   // by number of the part: the generation that must not be divided
  std::vector<std::uint64_t> waits_until;  // by number of the part, the frame
  std::vector<std::uint32_t> local_of;     // scratch: by number, the member; all kNone between calls
  std::vector<PartPiece> pieces;
  CycleSplitStats stats;
  std::uint64_t frame = 0;
  std::uint32_t next_look = 0;  // the node at which the next look for superfluous divisions begins
};

CycleSplitter::CycleSplitter(LayerSorter& sorter, CycleSplitSettings settings)
    : impl_(std::make_unique<Impl>(sorter, std::move(settings))) {}
CycleSplitter::~CycleSplitter() = default;
CycleSplitter::CycleSplitter(CycleSplitter&&) noexcept = default;
CycleSplitter& CycleSplitter::operator=(CycleSplitter&&) noexcept = default;

bool CycleSplitter::Impl::mayDivide(PartId part) const {
  return sorter->settingsOf(part).place == PartSettings::Place::kSorted && !sorter->isInContainer(part) &&
         (part.value >= kept_whole.size() || kept_whole[part.value] != sorter->generationOf(part));
}

// The part's hulls as the sort takes them; valid until hulls are added or changed.
std::vector<ConvexSet> CycleSplitter::Impl::setsOf(PartId part) const {
  std::vector<ConvexSet> sets;
  const PartStore& store = sorter->store();
  const Placement& placement = store.placements[part.value];
  const double erosion = sorter->settings().contact_tolerance;
  for (const std::uint32_t hull : store.hullsOf(part.value)) {
    ConvexSet& set = sets.emplace_back();
    set.hull = &store.hulls[hull];
    set.around = &store.envelopes[hull];
    set.placement = erosion > 0.0 ? eroded(placement, store.boxes[hull], 0.5 * erosion) : placement;
  }
  return sets;
}

double CycleSplitter::Impl::surfaceOfPart(PartId part) const {
  double surface = 0.0;
  for (const std::uint32_t hull : sorter->store().hullsOf(part.value)) {
    surface += surfaceOf(sorter->store().boxes[hull]);
  }
  return surface;
}

// The shape of a whole part: its triangles or, without, its hulls.
std::optional<PartShape> CycleSplitter::Impl::shapeOfPart(PartId part) const {
  PartShape shape;
  if (settings.triangles) {
    std::vector<std::array<Vec3d, 3>> triangles;
    settings.triangles(part, triangles);
    if (!triangles.empty()) {
      std::vector<ShapePolygon> polygons;
      for (const std::array<Vec3d, 3>& triangle : triangles) {
        polygons.emplace_back(triangle.begin(), triangle.end());
      }
      addBody(std::move(polygons), shape);
      return shape;
    }
  }
  for (const HullId id : sorter->hullsOf(part)) {
    if (sorter->hull(id).vertices.empty()) {
      return std::nullopt;
    }
    addBody(sorter->hull(id), shape);
  }
  return shape;
}

CycleMember CycleSplitter::Impl::memberOf(PartId part) const {
  CycleMember member{
      .part = wholeOf(part).value, .sets = setsOf(part), .placement = placementOf(sorter->transformOf(part))};
  member.surface = surfaceOfPart(part);
  const std::uint32_t node = trees.find(part);
  if (node != PieceTrees::kNone) {
    member.is_piece = true;
    member.weight = trees[node].weight;
    member.cuts_left = kMaxPieceSides - trees[node].depth;
  } else {
    member.cuts_left = kMaxPieceSides;
  }
  if (!mayDivide(wholeOf(part)) || !isFinite(member.placement)) {
    member.cuts_left = 0;
  }
  return member;
}

bool CycleSplitter::Impl::isWaiting(std::span<const PartId> parts) const {
  return std::all_of(parts.begin(), parts.end(), [&](PartId part) {
    const PartId whole = wholeOf(part);
    return whole.value < waits_until.size() && frame < waits_until[whole.value];
  });
}

void CycleSplitter::Impl::wait(std::span<const PartId> parts) {
  for (const PartId part : parts) {
    const PartId whole = wholeOf(part);
    waits_until.resize(std::max<std::size_t>(waits_until.size(), std::size_t{whole.value} + 1));
    waits_until[whole.value] = frame + settings.retry_frames;
  }
}

// Whether these are two convex parts that pass through each other. However they are divided, two pieces do.
bool CycleSplitter::Impl::isCrossedPair(std::span<const PartId> parts, const LayerOrder& order) const {
  if (parts.size() != 2 || !isSolid(parts[0]) || !isSolid(parts[1])) {
    return false;
  }
  const LayerArc pair{std::min(parts[0], parts[1]), std::max(parts[0], parts[1])};
  return std::binary_search(order.collisions.begin(), order.collisions.end(), pair);
}

// Tries the largest groups first. True if any was divided.
bool CycleSplitter::Impl::divideGroups(const View& view, std::span<const Vec3d> more_eyes,
                                       const LayerOrder& order) {
  if (!sorter->settings().exact || sorter->settings().arcs == LayerArcs::kNone) {
    return false;
  }
  const std::span<const Vec3d> further = view.orthographic ? std::span<const Vec3d>() : more_eyes;
  std::vector<Vec3d> eyes{view.orthographic ? farEye(view) : view.eye};
  eyes.insert(eyes.end(), further.begin(), further.end());
  const SetOcclusion occlusion(view, further);
  std::vector<std::uint32_t> groups;
  for (std::uint32_t i = order.first_sorted; i < order.sorted_end; ++i) {
    const std::span<const PartId> parts = order.group(i);
    if (parts.size() > 1 && !isWaiting(parts) && !isCrossedPair(parts, order)) {
      groups.push_back(i);
    }
  }
  std::stable_sort(groups.begin(), groups.end(), [&](std::uint32_t a, std::uint32_t b) {
    return order.group(a).size() > order.group(b).size();
  });
  bool any = false;
  for (const std::uint32_t i : groups) {
    if (trees.pieces() < settings.max_pieces && stats.trials < settings.max_trials) {
      any = divideGroup(order.group(i), order, occlusion, eyes) || any;
    }
  }
  return any;
}

bool CycleSplitter::Impl::divideGroup(std::span<const PartId> parts, const LayerOrder& order,
                                      const SetOcclusion& occlusion, std::span<const Vec3d> eyes) {
  std::vector<CycleMember> members;
  local_of.resize(sorter->parts(), PieceTrees::kNone);
  for (std::uint32_t i = 0; i < parts.size(); ++i) {
    members.push_back(memberOf(parts[i]));
    local_of[parts[i].value] = i;
  }
  const auto shapeOfMember = [&](std::uint32_t member) -> std::optional<PartShape> {
    const std::uint32_t node = trees.find(parts[member]);
    return node == PieceTrees::kNone ? shapeOfPart(parts[member]) : std::optional(trees[node].shape);
  };
  CycleDivision division(occlusion, eyes, std::move(members), shapeOfMember,
                         {.erosion = sorter->settings().contact_tolerance,
                          .max_pieces = settings.max_pieces - trees.pieces(),
                          .max_trials = settings.max_trials - stats.trials});
  for (const LayerArc& arc : order.arcs) {
    const std::uint32_t front = local_of[arc.front.value], back = local_of[arc.back.value];
    if (front != PieceTrees::kNone && back != PieceTrees::kNone) {
      division.addArc(front, back);
    }
  }
  for (const PartId part : parts) {
    local_of[part.value] = PieceTrees::kNone;
  }
  const bool falls_apart = division.run();
  stats.trials += division.trials();
  if (!falls_apart || !make(division, parts)) {
    wait(parts);
    return false;
  }
  return true;
}

// Divides the sorter's parts as the division found. False if the hulls of the pieces cannot be built.
bool CycleSplitter::Impl::make(CycleDivision& division, std::span<const PartId> parts) {
  for (const DivisionCut& cut : division.cuts()) {
    if (!buildHulls(division.shape(cut.front)) || !buildHulls(division.shape(cut.behind))) {
      return false;
    }
  }
  std::vector<std::pair<std::uint32_t, std::uint32_t>> made;  // node of the division, node of the trees
  for (const DivisionCut& cut : division.cuts()) {
    const auto known =
        std::find_if(made.begin(), made.end(), [&](const auto& pair) { return pair.first == cut.node; });
    const std::uint32_t node = known != made.end() ? known->second : trees.rootOf(parts[cut.node]);
    if (trees[node].parent == PieceTrees::kNone) {
      trees[node].generation = sorter->generationOf(trees[node].whole);
    }
    const auto [front, behind] =
        trees.divide(node, cut.plane, std::move(division.shape(cut.front)),
                     std::move(division.shape(cut.behind)), division.weightOf(cut.front));
    made.emplace_back(cut.front, front);
    made.emplace_back(cut.behind, behind);
    ++stats.cuts;
  }
  return true;
}

// A division is superfluous if the whole has a place in the order: behind the groups of all that occlude it,
// and in front of those of all that it occludes. In one group with something else, it may be there if both
// halves are.
void CycleSplitter::Impl::look(std::uint32_t number, const SetOcclusion& occlusion, const LayerOrder& order) {
  PieceTrees::Node& node = trees[number];
  const PartId front = trees[node.front].part, behind = trees[node.behind].part;
  const std::vector<ConvexSet> own = node.parent == PieceTrees::kNone
                                         ? setsOf(node.part)
                                         : node.shape.placed(placementOf(sorter->transformOf(node.whole)),
                                                             sorter->settings().contact_tolerance);
  std::uint32_t first_behind = PieceTrees::kNone, last_in_front = 0;
  std::uint32_t group_of_front = PieceTrees::kNone, group_of_behind = PieceTrees::kNone;
  bool any_in_front = false, has_place = true;
  for (std::uint32_t i = order.first_sorted; i < order.sorted_end && has_place; ++i) {
    for (const PartId part : order.group(i)) {
      if (part == front || part == behind) {
        (part == front ? group_of_front : group_of_behind) = i;
        continue;
      }
      const std::vector<ConvexSet> sets = setsOf(part);
      // Both halves have the rules of the whole, among them the planes between it and its part's other
      // pieces.
      const PairOrder rule = sorter->orderByRule(front, part);
      // Groups come from front to back, so the first that is occluded is enough.
      if (first_behind == PieceTrees::kNone && rule.first_may_occlude && occlusion.occludes(own, sets)) {
        first_behind = i;
      }
      if (rule.second_may_occlude && occlusion.occludes(sets, own)) {
        last_in_front = i;
        any_in_front = true;
      }
    }
    has_place = !any_in_front || last_in_front <= first_behind;
  }
  const bool meets = any_in_front && last_in_front == first_behind;
  const bool in_vain = group_of_front == group_of_behind && group_of_front == first_behind;
  const bool superfluous = has_place && (!meets || in_vain);
  if (superfluous && !node.is_superfluous) {
    node.superfluous_since = frame;
  }
  node.is_superfluous = superfluous;
  node.is_in_vain = superfluous && meets;
}

// Looks at a few divisions, each in its turn.
void CycleSplitter::Impl::lookAtDivisions(const View& view, std::span<const Vec3d> more_eyes,
                                          const LayerOrder& order) {
  const SetOcclusion occlusion(view, view.orthographic ? std::span<const Vec3d>() : more_eyes);
  const std::uint32_t first = next_look;
  std::uint32_t looks = 0;
  for (std::uint32_t i = 0; i < trees.size() && looks < kLooks; ++i) {
    const std::uint32_t number = (first + i) % trees.size();
    if (trees.canJoin(number)) {
      look(number, occlusion, order);
      next_look = number + 1;
      ++looks;
    }
  }
}

void CycleSplitter::Impl::joinSuperfluous() {
  for (std::uint32_t number = 0; number < trees.size(); ++number) {
    const PieceTrees::Node& node = trees[number];
    const std::uint32_t frames = node.is_in_vain ? settings.keep_frames / kInVainShare : settings.keep_frames;
    if (trees.canJoin(number) && node.is_superfluous && frame >= node.superfluous_since + frames) {
      trees.join(number);
      ++stats.joins;
    }
  }
}

// The sorter's parts may have been enabled and removed since the last update.
void CycleSplitter::Impl::followParts() {
  std::vector<PartId> gone;
  for (std::uint32_t number = 0; number < trees.size(); ++number) {
    const PieceTrees::Node& node = trees[number];
    if (!node.in_use || node.parent != PieceTrees::kNone) {
      continue;
    }
    if (sorter->generationOf(node.whole) == node.generation) {
      sorter->setEnabled(node.whole, false);
    } else {
      gone.push_back(node.whole);
    }
  }
  for (const PartId part : gone) {
    const bool enabled = sorter->isEnabled(part);  // of a new part with this number
    trees.joinAll(part);
    sorter->setEnabled(part, enabled);
  }
}

void CycleSplitter::Impl::joinAll() {
  followParts();
  std::vector<PartPiece> divided;
  trees.collect(divided);
  for (const PartPiece& piece : divided) {
    trees.joinAll(piece.part);
  }
}

void CycleSplitter::setMayDivide(PartId part, bool may) {
  const std::uint64_t generation = impl_->sorter->generationOf(part);
  if (generation == 0) {
    return;  // no part has this number, which may be the greatest one
  }
  std::vector<std::uint64_t>& kept = impl_->kept_whole;
  kept.resize(std::max<std::size_t>(kept.size(), std::size_t{part.value} + 1));
  kept[part.value] = may ? 0 : generation;
}

void CycleSplitter::join(PartId part) {
  impl_->trees.joinAll(part);
}

const LayerOrder& CycleSplitter::update(const View& view, std::span<const Vec3d> more_eyes) {
  Impl& own = *impl_;
  ++own.frame;
  own.stats = {};
  own.followParts();
  own.joinSuperfluous();
  own.trees.place();
  const LayerOrder* order = &own.sorter->update(view, more_eyes);
  if (own.divideGroups(view, more_eyes, *order)) {
    order = &own.sorter->update(view, more_eyes);
  } else if (own.trees.pieces() > 0) {
    own.lookAtDivisions(view, more_eyes, *order);
  }
  own.trees.collect(own.pieces);
  own.stats.divided = own.trees.dividedParts();
  own.stats.pieces = own.trees.pieces();
  return *order;
}

std::span<const PartPiece> CycleSplitter::pieces() const {
  return impl_->pieces;
}

PartId CycleSplitter::partOf(PartId piece) const {
  return impl_->wholeOf(piece);
}

const CycleSplitStats& CycleSplitter::stats() const {
  return impl_->stats;
}

}  // namespace sightline
