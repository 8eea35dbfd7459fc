// Based on: Saona-Vazquez, Navazo, Brunet. The Visibility Octree. Computers & Graphics 1999, section 3.2.
// Differs from the paper in: the search box is the cell, grown on all sides, so that all of its corners test
// the same occluders; occluders do not count for viewers that come closer to them than their near planes.

#include "src/pvs/bake/cell_sets.h"

#include <algorithm>
#include <array>

namespace sightline::pvs {
namespace {

// An occluder is near a cell within this distance, in edge lengths of the cell. Farther away it looks small,
// unless it is as large as the cell.
constexpr double kNearInEdges = 0.5;

// Units of BakeCounts::work. By single convex occluders, an object takes one, from a region or from a point.
constexpr std::uint64_t kSurfaceWork = 100;  // to ask whether surfaces hide a box
// The same where surfaces are narrowed or divided. The work of a cell that is divided, which they are not in,
// stands for that of the cells below it.
constexpr std::uint64_t kThoroughWork = 400;

// Lists handed to the cells within another one have at most so many occluders in all, 28 bytes each. They are
// made for cells of the last levels only: those of larger cells would be too long.
constexpr std::size_t kMostHanded = 4'000'000;
constexpr std::uint32_t kHandingLevels = 3;

}  // namespace

CellBaker::CellBaker(const BakeScene& scene, const Recall* recall)
    : scene_(scene),
      recall_(scene, recall),
      search_(scene),
      samples_(scene.occluders, scene.shadow_tree, scene.reach, scene.sampleBytes()),
      surfaces_(scene, scene.panels),
      occluders_(scene),
      dividing_gain_(scene, recall_, search_, samples_, surfaces_.questions()),
      closed_doors_(scene, samples_),
      witnesses_(scene) {}

void CellBaker::startCell(const OctreeCell& cell) {
  cell_ = cellNumber(cell);
  recall_.startCell(cell_);
  witnesses_.startCell(cell_);
}

BakeStats CellBaker::stats() const {
  BakeStats stats = samples_.stats();
  stats.shadows += search_.shadowCount();
  stats.questions = counts_.questions + dividing_gain_.counts().questions;
  stats.asked = counts_.asked + dividing_gain_.counts().asked;
  return stats;
}

bool CellBaker::searchedAll(const OctreeCell& cell, double search_distance) const {
  return scene_.holdsAllOccluders(searchBox(scene_, cell, search_distance));
}

bool CellBaker::tooLargeForItsOccluders(const OctreeCell& cell) const {
  return scene_.holdsSmallOccluders(searchBox(scene_, cell, kNearInEdges * scene_.boxOf(cell).extent().x),
                                    cell.level);
}

CellSets CellBaker::seenFrom(const OctreeCell& cell, double search_distance, const Runs& seen) {
  startCell(cell);
  const CellBox box = scene_.regionOf(cell);
  faces_.clear();
  scene_.findFaces(grown(box, 2.0 * scene_.settings.near_distance), faces_);
  CellSets sets;
  parent_seen_ = seen;
  sets.whole = seen;
  if (seen.empty()) {
    sets.whole = {{0, static_cast<std::uint32_t>(scene_.boxes.objects.size())}};
  }
  sets.plane = dividingPlane(box, faces_, scene_.settings.near_distance, scene_.side_margin);
  if (sets.plane) {
    sets.front = sets.back = sets.whole;
  }
  occluders_.choose(cell, search_distance, cell.level);
  removeHidden(box, sets);
  if (fused()) {
    removeFused(box, scene_.mayDivide(cell) ? RegionEffort{} : effortOf(scene_.settings), sets);
  }
  return sets;
}

void CellBaker::lookCloser(const OctreeCell& cell, CellSets& sets) {
  if (fused() && isThorough(scene_.settings)) {
    startCell(cell);
    removeFused(scene_.regionOf(cell), effortOf(scene_.settings), sets);
  }
}

void CellBaker::lookFarther(const OctreeCell& cell, double searched, double search_distance, CellSets& sets) {
  startCell(cell);
  occluders_.choose(cell, search_distance, cell.level);
  occluders_.leaveOutWithin(searched);
  removeHidden(scene_.regionOf(cell), sets);
}

void CellBaker::closeDoors(const OctreeCell& cell, double search_distance, CellSets& sets) {
  closed_doors_.hide(scene_.regionOf(cell), searchBox(scene_, cell, search_distance), sets);
}

// What is seen from a side is seen from the whole cell, so that little is left to be asked from there. That
// holds while the same is known of both. When occluders are looked for farther away, more may be known of a
// side, which surfaces hide more from, and then occluders of what it does not see do not count for it.
void CellBaker::removeHidden(const CellBox& box, CellSets& sets) {
  const auto object_count = static_cast<std::uint32_t>(scene_.boxes.objects.size());
  seen_from_side_.reset(object_count);
  if (!sets.plane) {
    removeHiddenFrom(cornersOf(box), WitnessPart::kWhole, sets.whole);
    return;
  }
  const SideCorners sides(box, *sets.plane, scene_.side_margin);
  const auto removeFrom = [&](std::span<const Vec3d> corners, WitnessPart part, Runs& side) {
    intersect(side, sets.whole, scratch_);
    side.swap(scratch_);
    removeHiddenFrom(corners, part, side);
  };
  const bool side_first = !occluders_.choice().known;
  const bool front_is_larger = sides.front.size() >= sides.back.size();
  if (side_first && front_is_larger) {
    removeFrom(sides.front, WitnessPart::kFront, sets.front);
    seen_from_side_.add(sets.front);
  } else if (side_first) {
    removeFrom(sides.back, WitnessPart::kBack, sets.back);
    seen_from_side_.add(sets.back);
  }
  removeHiddenFrom(cornersOf(box), WitnessPart::kWhole, sets.whole);
  seen_from_side_.reset(object_count);
  if (!side_first || !front_is_larger) {
    removeFrom(sides.front, WitnessPart::kFront, sets.front);
  }
  if (!side_first || front_is_larger) {
    removeFrom(sides.back, WitnessPart::kBack, sets.back);
  }
}

void CellBaker::removeFused(const CellBox& box, const RegionEffort& effort, CellSets& sets) {
  removeFusedFrom(box, WitnessPart::kWhole, effort, sets.whole);
  if (!sets.plane) {
    return;
  }
  const SideCorners sides(box, *sets.plane, scene_.side_margin);
  const auto removeFrom = [&](std::span<const Vec3d> corners, WitnessPart part, Runs& side) {
    intersect(side, sets.whole, scratch_);
    side.swap(scratch_);
    // The box around a side of a slanted plane is often the cell, which has been asked about.
    if (corners.empty()) {
      return;
    }
    if (const CellBox around = boundsOf(corners); around.extent() != box.extent()) {
      removeFusedFrom(around, part, effort, side);
    }
  };
  removeFrom(sides.front, WitnessPart::kFront, sets.front);
  removeFrom(sides.back, WitnessPart::kBack, sets.back);
}

void CellBaker::removeFusedFrom(const CellBox& region, WitnessPart part, const RegionEffort& effort,
                                Runs& seen) {
  witnesses_.startPart(part);
  if (seen.empty()) {
    return;
  }
  const std::array<Vec3d, 2> ends{region.min, region.max};
  const std::array<double, 2> numbers{static_cast<double>(effort.narrowings),
                                      static_cast<double>(effort.divisions)};
  Answer answer{.kind = AnswerKind::kFused, .question = questionOf(ends, numbers)};
  recall_.compareNodes(recall_.find(answer));
  hidden_nodes_.clear();
  followed_.clear();
  hidden_.resetWithout(seen, static_cast<std::uint32_t>(scene_.boxes.objects.size()));
  removeFusedBelow(0, region, effort);
  hidden_.complement(seen);
  answer.seen = seen;
  answer.hidden_nodes = hidden_nodes_;
  answer.followed = followed_;
  recall_.keep(std::move(answer));
}

bool CellBaker::surfacesHide(std::uint32_t number, const CellBox& region, const RegionEffort& effort) {
  ++counts_.questions;
  counts_.work += isThorough(scene_.settings) ? kThoroughWork : kSurfaceWork;
  if (const std::optional<CellRecall::NodeAnswer> before = recall_.node(number, region)) {
    followed_.push_back(before->followed);
    return before->hidden;
  }
  ++counts_.asked;
  surfaces_.questions().takeFollowed();
  const bool hidden = surfaces_.hides(number, region, effort);
  followed_.push_back(coarse(surfaces_.questions().takeFollowed(), scene_.frame));
  return hidden;
}

void CellBaker::removeFusedBelow(std::uint32_t number, const CellBox& region, const RegionEffort& effort) {
  const BoxTreeView boxes = scene_.boxes.view();
  const BoxNode& node = boxes.nodes[number];
  const ObjectRun objects{node.first_object, node.first_object + node.object_count};
  if (hidden_.containsAll(objects)) {
    return;
  }
  if (surfacesHide(number, region, effort)) {
    hidden_nodes_.push_back(number);
    witnesses_.addSurfaces(surfaces_, objects, hidden_);
    hidden_.add(std::span(&objects, 1));
    return;
  }
  for (std::uint32_t child = number + 1; child < node.end; child = boxes.nodes[child].end) {
    removeFusedBelow(child, region, effort);
  }
}

void CellBaker::removeHiddenFrom(std::span<const Vec3d> corners, WitnessPart part, Runs& seen) {
  witnesses_.startPart(part);
  if (corners.empty()) {
    seen.clear();  // there are no viewers
    return;
  }
  const CellOccluders::Choice& choice = occluders_.choice();
  const std::array numbers{choice.distance, choice.distance_before, static_cast<double>(choice.level),
                           static_cast<double>(part)};
  Answer answer{.kind = AnswerKind::kConvex, .question = questionOf(corners, numbers), .asked = seen};
  hidden_.resetWithout(seen, static_cast<std::uint32_t>(scene_.boxes.objects.size()));
  const Answer* before = recall_.find(answer);
  counts_.questions += countOf(seen);
  counts_.work += countOf(seen);
  if (before == nullptr || !hideAsBefore(*before, corners, seen)) {
    counts_.asked += countOf(seen);
    hideByChosen(corners);
  }
  hidden_.remove(seen_from_side_);
  hidden_.complement(seen);
  answer.seen = seen;
  recall_.keep(std::move(answer));
}

// The lists only save time. So it does not matter which cell's they were made from, and that they are missing
// where they would be too long. Which occluder hides an object may depend on them, though, if several do; so
// there are none where witnesses are recorded.
const CellCandidates* CellBaker::listsAround() {
  if (parent_seen_.empty() || scene_.settings.witnesses) {
    return nullptr;
  }
  const std::uint64_t parent = cell_ >> 3;
  const std::size_t level = cellOfNumber(parent).level;
  if (level + kHandingLevels < scene_.settings.max_depth) {
    return nullptr;
  }
  while (handed_.size() <= level) {
    handed_.push_back({.lists = CellCandidates(scene_)});
  }
  Handed& of_parent = handed_[level];
  if (of_parent.cell != parent) {
    const CellCandidates* around = nullptr;
    for (std::size_t above = level; above-- > 0 && around == nullptr;) {
      const Handed& handed = handed_[above];
      around = handed.usable && handed.cell == parent >> (3 * (level - above)) ? &handed.lists : nullptr;
    }
    hidden_from_parent_.resetWithout(parent_seen_, static_cast<std::uint32_t>(scene_.boxes.objects.size()));
    of_parent.cell = parent;
    of_parent.usable =
        of_parent.lists.make(scene_.regionOf(cellOfNumber(parent)), hidden_from_parent_, around, kMostHanded);
  }
  return of_parent.usable ? &of_parent.lists : nullptr;
}

void CellBaker::hideByChosen(std::span<const Vec3d> corners) {
  if (scene_.sampleBytes() > 0) {
    hideBySamples(corners);
    return;
  }
  const CellCandidates* lists = listsAround();
  const std::span<const ConvexSearch::Found> found =
      lists != nullptr ? search_.hiddenFrom(corners, occluders_.choice(), hidden_, seen_from_side_, *lists)
                       : search_.hiddenFrom(corners, occluders_.choice(), hidden_);
  witnesses_.addFound(found, hidden_);
  for (const ConvexSearch::Found& by_one : found) {
    hidden_.add({&by_one.objects, 1});
  }
}

// Skips an occluder whose object is already hidden. What such an occluder hides is hidden by that which hides
// its object (docs/conservative.md, "Sets from regions"). So an object is hidden if and only if some chosen
// occluder of an object that was not hidden before hides it, in whatever order they are asked.
void CellBaker::hideBySamples(std::span<const Vec3d> corners) {
  std::vector<Sample*> samples;
  for (const Vec3d& corner : corners) {
    samples.push_back(&samples_.at(corner));
  }
  for (const std::uint32_t i : occluders_.ranked()) {
    const ConvexOccluder& occluder = scene_.occluders[i];
    if (!hidden_.contains(scene_.position_of_occluder[i]) &&
        separated(scene_.occluders, occluder, corners, scene_.settings.near_distance) &&
        samples_.hiddenFromAll(i, samples, common_)) {
      witnesses_.addConvex(i, common_, hidden_);
      hidden_.add(common_);
    }
  }
}

bool CellBaker::hideAsBefore(const Answer& before, std::span<const Vec3d> corners, const Runs& seen) {
  if (!recall_.compareObjects(before, corners, hidden_)) {
    return false;
  }
  common_.clear();
  for (const ObjectRun& run : seen) {
    for (std::uint32_t i = run.begin; i < run.end; ++i) {
      const CellRecall::Known known = recall_.object(i);
      bool hidden = known == CellRecall::Known::kHidden;
      if (known == CellRecall::Known::kNothing) {
        ++counts_.asked;
        hidden = search_.hides(corners, occluders_.choice(), hidden_, i);
      }
      if (hidden) {
        appendRun({i, i + 1}, common_);
      }
    }
  }
  hidden_.add(common_);
  return true;
}

std::uint64_t trianglesOf(const BakeScene& scene, const CellSets& sets) {
  return sets.plane ? std::max(scene.triangles.of(sets.front), scene.triangles.of(sets.back))
                    : scene.triangles.of(sets.whole);
}

}  // namespace sightline::pvs
