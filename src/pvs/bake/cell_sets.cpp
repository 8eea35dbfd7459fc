// Based on: Saona-Vazquez, Navazo, Brunet. The Visibility Octree. Computers & Graphics 1999, section 3.2.
// Differs from the paper in: the search box is the cell, grown on all sides, so that all of its corners test
// the same occluders; whether dividing helps is tested at points within the cell too, because the sets of a
// large cell's corners say little about what its parts will see; occluders do not count for viewers that come
// closer to them than their near planes.

#include "src/pvs/bake/cell_sets.h"

#include <algorithm>
#include <array>

namespace sightline::pvs {
namespace {

// An occluder is near a cell within this distance, in edge lengths of the cell. Farther away it looks small,
// unless it is as large as the cell.
constexpr double kNearInEdges = 0.5;

// Units of CellBaker::work. By single convex occluders, an object takes one, from a region or from a point.
constexpr std::uint64_t kSurfaceWork = 100;  // to ask whether surfaces hide a box
// The same where surfaces are narrowed or divided. The work of a cell that is divided, which they are not in,
// stands for that of the cells below it.
constexpr std::uint64_t kThoroughWork = 400;
constexpr std::uint64_t kLineWork = 5;  // to ask whether a line of sight is clear

// Lists handed to the cells within another one have at most so many occluders in all, 28 bytes each. They are
// made for cells of the last levels only: those of larger cells would be too long.
constexpr std::size_t kMostHanded = 4'000'000;
constexpr std::uint32_t kHandingLevels = 3;

std::uint64_t countOf(std::span<const ObjectRun> runs) {
  std::uint64_t count = 0;
  for (const ObjectRun& run : runs) {
    count += run.end - run.begin;
  }
  return count;
}

}  // namespace

CellBaker::CellBaker(const BakeScene& scene, const Recall* recall)
    : scene_(scene),
      recall_(scene, recall),
      search_(scene),
      samples_(scene.occluders, scene.shadow_tree, scene.reach, scene.sampleBytes()),
      surfaces_(scene, scene.panels),
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
  stats.questions = questions_;
  stats.asked = asked_;
  return stats;
}

CellBox CellBaker::searchBox(const OctreeCell& cell, double search_distance) const {
  const CellBox box = scene_.boxOf(cell);
  const Vec3d grown{search_distance, search_distance, search_distance};
  return {box.min - grown, box.max + grown};
}

bool CellBaker::searchedAll(const OctreeCell& cell, double search_distance) const {
  return scene_.holdsAllOccluders(searchBox(cell, search_distance));
}

bool CellBaker::tooLargeForItsOccluders(const OctreeCell& cell) const {
  return scene_.holdsSmallOccluders(searchBox(cell, kNearInEdges * scene_.boxOf(cell).extent().x),
                                    cell.level);
}

void CellBaker::chooseOccluders(const OctreeCell& cell, double search_distance, std::uint32_t level) {
  choice_ = Choice();
  choice_.cell = scene_.boxOf(cell);
  choice_.search = searchBox(cell, search_distance);
  choice_.distance = search_distance;
  choice_.level = level;
  chosen_.clear();
}

std::span<const std::uint32_t> CellBaker::chosenOccluders() {
  if (!chosen_.empty()) {
    return chosen_;
  }
  scene_.findOccluders(choice_.search, choice_.level, chosen_);
  if (choice_.known) {
    std::erase_if(chosen_,
                  [&](std::uint32_t i) { return intersects(*choice_.known, scene_.occluders[i].bounds); });
  }
  const Vec3d extent = choice_.cell.extent();
  ranked_.clear();
  for (const std::uint32_t i : chosen_) {
    const ConvexOccluder& occluder = scene_.occluders[i];
    const Vec3d gap = gapBetween(choice_.cell, occluder.bounds);
    ranked_.emplace_back(-occluder.area / (dot(gap, gap) + dot(extent, extent)), i);
  }
  std::sort(ranked_.begin(), ranked_.end());
  std::transform(ranked_.begin(), ranked_.end(), chosen_.begin(), [](const auto& r) { return r.second; });
  return chosen_;
}

CellSets CellBaker::seenFrom(const OctreeCell& cell, double search_distance, const Runs& seen) {
  startCell(cell);
  const CellBox box = scene_.regionOf(cell);
  const double near = 2.0 * scene_.settings.near_distance;
  faces_.clear();
  scene_.findFaces({box.min - Vec3d{near, near, near}, box.max + Vec3d{near, near, near}}, faces_);
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
  chooseOccluders(cell, search_distance, cell.level);
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
  chooseOccluders(cell, search_distance, cell.level);
  choice_.known = searchBox(cell, searched);
  choice_.distance_before = searched;
  removeHidden(scene_.regionOf(cell), sets);
}

void CellBaker::closeDoors(const OctreeCell& cell, double search_distance, CellSets& sets) {
  closed_doors_.hide(scene_.regionOf(cell), searchBox(cell, search_distance), sets);
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
  const bool side_first = !choice_.known;
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
  ++questions_;
  work_ += isThorough(scene_.settings) ? kThoroughWork : kSurfaceWork;
  if (const std::optional<CellRecall::NodeAnswer> before = recall_.node(number, region)) {
    followed_.push_back(before->followed);
    return before->hidden;
  }
  ++asked_;
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
  const std::array numbers{choice_.distance, choice_.distance_before, static_cast<double>(choice_.level),
                           static_cast<double>(part)};
  Answer answer{.kind = AnswerKind::kConvex, .question = questionOf(corners, numbers), .asked = seen};
  hidden_.resetWithout(seen, static_cast<std::uint32_t>(scene_.boxes.objects.size()));
  const Answer* before = recall_.find(answer);
  questions_ += countOf(seen);
  work_ += countOf(seen);
  if (before == nullptr || !hideAsBefore(*before, corners, seen)) {
    asked_ += countOf(seen);
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
      lists != nullptr ? search_.hiddenFrom(corners, choice_, hidden_, seen_from_side_, *lists)
                       : search_.hiddenFrom(corners, choice_, hidden_);
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
  for (const std::uint32_t i : chosenOccluders()) {
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
        ++asked_;
        hidden = search_.hides(corners, choice_, hidden_, i);
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

std::uint64_t CellBaker::trianglesSeenFrom(const Vec3d& eye) {
  hidden_.reset(static_cast<std::uint32_t>(scene_.boxes.objects.size()));
  Sample& sample = samples_.at(eye);
  for (const std::uint32_t i : chosenOccluders()) {
    const ConvexOccluder& occluder = scene_.occluders[i];
    if (!hidden_.contains(scene_.position_of_occluder[i]) &&
        separated(scene_.occluders, occluder, std::span(&eye, 1), scene_.settings.near_distance)) {
      hidden_.add(samples_.hidden(sample, i));
    }
  }
  hidden_.complement(scratch_);
  return scene_.triangles.of(scratch_);
}

bool CellBaker::seesFewer(const Vec3d& eye, double triangles) {
  const std::array numbers{choice_.distance, static_cast<double>(choice_.level)};
  Answer answer{.kind = AnswerKind::kPoint, .question = questionOf(std::span(&eye, 1), numbers)};
  ++questions_;
  work_ += scene_.boxes.objects.size();
  if (recall_.boundTriangles(eye, answer)) {
    const bool fewer = static_cast<double>(answer.most) < triangles;
    if (fewer || !(static_cast<double>(answer.least) < triangles)) {
      recall_.keep(std::move(answer));
      return fewer;
    }
  }
  ++asked_;
  if (scene_.sampleBytes() > 0) {
    answer.least = answer.most = trianglesSeenFrom(eye);
  } else {
    const ConvexSearch::Bounds seen = search_.trianglesSeenFrom(eye, choice_, triangles);
    answer.least = seen.least;
    answer.most = seen.most;
  }
  const bool fewer = static_cast<double>(answer.most) < triangles;
  recall_.keep(std::move(answer));
  return fewer;
}

double CellBaker::shareSeenFrom(const Vec3d& point, const Runs& seen) {
  constexpr std::uint64_t kObjects = 128;  // that are asked about
  constexpr int kLines = 3;                // to each
  std::uint64_t at = 0;
  const std::uint64_t step = countOf(seen) / kObjects + 1;
  double all = 0.0, clear = 0.0;
  std::uint32_t random = 1;
  for (const ObjectRun& run : seen) {
    for (std::uint64_t i = (step - at % step) % step; i < run.end - run.begin; i += step) {
      const auto position = static_cast<std::uint32_t>(run.begin + i);
      const BoxNode& leaf = scene_.leafOf(position);
      all += leaf.triangles;
      for (int line = 0; line < kLines; ++line) {
        work_ += kLineWork;
        Vec3d to(leaf.bounds.min);
        for (int axis = 0; axis < 3; ++axis) {
          random = random * 1664525u + 1013904223u;
          to[axis] += double{leaf.bounds.max[axis] - leaf.bounds.min[axis]} * (random >> 8) * 0x1p-24;
        }
        if (surfaces_.questions().isClear(point, to)) {
          clear += leaf.triangles;
          break;
        }
      }
    }
    at += run.end - run.begin;
  }
  return all > 0.0 ? clear / all : 1.0;
}

bool CellBaker::dividingHelps(const OctreeCell& cell, double search_distance, const CellSets& sets) {
  const CellBox box = scene_.regionOf(cell);
  chooseOccluders(cell, search_distance, scene_.settings.max_depth);
  std::vector<Vec3d> points{box.centre()};
  for (std::uint32_t i = 0; i < 8; ++i) {
    if (scene_.settings.whole_cells || scene_.holdsViewers(scene_.boxOf(cell.child(i)))) {
      points.push_back(scene_.regionOf(cell.child(i)).centre());
    }
  }
  const std::vector<Vec3d> corners = cornersOf(box);
  points.insert(points.end(), corners.begin(), corners.end());
  return std::any_of(points.begin(), points.end(), [&](const Vec3d& point) {
    const Runs* side = &sets.whole;
    if (sets.plane) {
      const CellSide at = sideOf(*sets.plane, point);
      side = at == CellSide::kFront ? &sets.front : at == CellSide::kBack ? &sets.back : nullptr;
    }
    if (side == nullptr) {
      return false;
    }
    if (fused()) {
      return shareSeenFrom(point, *side) < 1.0 - scene_.settings.similarity;
    }
    const double cell_triangles = static_cast<double>(scene_.triangles.of(*side));
    return seesFewer(point, (1.0 - scene_.settings.similarity) * cell_triangles);
  });
}

}  // namespace sightline::pvs
