// Based on: Saona-Vazquez, Navazo, Brunet. The Visibility Octree. Computers & Graphics 1999, section 3.2.
// Differs from the paper in: the search box is the cell, grown on all sides, so that all of its corners test
// the same occluders; whether dividing helps is tested at points within the cell too, because the sets of a
// large cell's corners say little about what its parts will see; occluders do not count for viewers that come
// closer to them than their near planes.

#include "src/pvs/bake/cell_sets.h"

#include <algorithm>

namespace sightline::pvs {
namespace {

// An occluder is near a cell within this distance, in edge lengths of the cell. Farther away it looks small,
// unless it is as large as the cell.
constexpr double kNearInEdges = 0.5;

// A bound of the absolute coordinates of all cells and all objects that may be hidden.
double magnitudeOf(const BakeScene& scene) {
  double magnitude = maxComponent(max(abs(scene.root.min), abs(scene.root.max)));
  for (const BoxNode& node : scene.boxes.nodes) {
    if (node.bounds.wellFormed()) {
      magnitude =
          std::max(magnitude, maxComponent(max(abs(Vec3d(node.bounds.min)), abs(Vec3d(node.bounds.max)))));
    }
  }
  return magnitude;
}

// The corners of the regions in front of a cell's plane and behind it, as far as they are for viewers.
struct SideCorners {
  std::vector<Vec3d> front, back;

  SideCorners(const CellBox& box, const CellPlane& plane, double side_margin)
      : front(cornersBefore(box, plane.normal, plane.front - 2.0 * side_margin)),
        back(cornersBefore(box, -plane.normal, -plane.back - 2.0 * side_margin)) {}
};

}  // namespace

void ObjectMask::reset(std::uint32_t count) {
  count_ = count;
  words_.assign((count + 63) / 64, 0);
}

void ObjectMask::resetWithout(std::span<const ObjectRun> runs, std::uint32_t count) {
  reset(count);
  std::uint32_t begin = 0;
  for (const ObjectRun& run : runs) {
    addRun({begin, run.begin});
    begin = run.end;
  }
  addRun({begin, count});
}

void ObjectMask::add(std::span<const ObjectRun> runs) {
  for (const ObjectRun& run : runs) {
    addRun(run);
  }
}

void ObjectMask::addRun(const ObjectRun& run) {
  if (run.begin == run.end) {
    return;
  }
  const std::uint32_t first = run.begin / 64, last = (run.end - 1) / 64;
  const std::uint64_t low = ~std::uint64_t{0} << run.begin % 64;
  const std::uint64_t high = ~std::uint64_t{0} >> (63 - (run.end - 1) % 64);
  if (first == last) {
    words_[first] |= low & high;
    return;
  }
  words_[first] |= low;
  std::fill(words_.begin() + first + 1, words_.begin() + last, ~std::uint64_t{0});
  words_[last] |= high;
}

bool ObjectMask::containsAll(const ObjectRun& run) const {
  std::uint32_t i = run.begin;
  while (i < run.end && contains(i)) {
    // Whole words at once.
    i += i % 64 == 0 && i + 64 <= run.end && words_[i / 64] == ~std::uint64_t{0} ? 64 : 1;
  }
  return i >= run.end;
}

void ObjectMask::complement(Runs& out) const {
  out.clear();
  for (std::uint32_t i = 0; i < count_; ++i) {
    if (i % 64 == 0 && words_[i / 64] == ~std::uint64_t{0}) {
      i += 63;
    } else if (!contains(i)) {
      if (!out.empty() && out.back().end == i) {
        out.back().end = i + 1;
      } else {
        out.push_back({i, i + 1});
      }
    }
  }
}

CellBaker::CellBaker(const BakeScene& scene)
    : scene_(scene),
      samples_(scene.occluders, scene.shadow_tree, scene.reach, scene.settings.sample_bytes),
      surfaces_(scene.panels, scene.settings.near_distance, magnitudeOf(scene)) {}

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
  chosen_.clear();
  scene_.findOccluders(searchBox(cell, search_distance), level, chosen_);
  const CellBox box = scene_.boxOf(cell);
  const Vec3d extent = box.extent();
  ranked_.clear();
  for (const std::uint32_t i : chosen_) {
    const ConvexOccluder& occluder = scene_.occluders[i];
    const Vec3d gap = gapBetween(box, occluder.bounds);
    ranked_.emplace_back(-occluder.area / (dot(gap, gap) + dot(extent, extent)), i);
  }
  std::sort(ranked_.begin(), ranked_.end());
  std::transform(ranked_.begin(), ranked_.end(), chosen_.begin(), [](const auto& r) { return r.second; });
}

CellSets CellBaker::seenFrom(const OctreeCell& cell, double search_distance, const Runs& seen) {
  cell_ = cellNumber(cell);
  const CellBox box = scene_.boxOf(cell);
  const double near = 2.0 * scene_.settings.near_distance;
  faces_.clear();
  scene_.findFaces({box.min - Vec3d{near, near, near}, box.max + Vec3d{near, near, near}}, faces_);
  CellSets sets;
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
    removeFused(box, sets);
  }
  return sets;
}

void CellBaker::lookFarther(const OctreeCell& cell, double searched, double search_distance, CellSets& sets) {
  cell_ = cellNumber(cell);
  chooseOccluders(cell, search_distance, cell.level);
  const CellBox known = searchBox(cell, searched);
  std::erase_if(chosen_, [&](std::uint32_t i) { return intersects(known, scene_.occluders[i].bounds); });
  removeHidden(scene_.boxOf(cell), sets);
}

void CellBaker::removeHidden(const CellBox& box, CellSets& sets) {
  removeHiddenFrom(cornersOf(box), WitnessPart::kWhole, sets.whole);
  if (sets.plane) {
    const SideCorners sides(box, *sets.plane, scene_.side_margin);
    removeHiddenFrom(sides.front, WitnessPart::kFront, sets.front);
    removeHiddenFrom(sides.back, WitnessPart::kBack, sets.back);
  }
}

void CellBaker::removeFused(const CellBox& box, CellSets& sets) {
  removeFusedFrom(box, WitnessPart::kWhole, sets.whole);
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
      removeFusedFrom(around, part, side);
    }
  };
  removeFrom(sides.front, WitnessPart::kFront, sets.front);
  removeFrom(sides.back, WitnessPart::kBack, sets.back);
}

void CellBaker::removeFusedFrom(const CellBox& region, WitnessPart part, Runs& seen) {
  part_ = part;
  if (seen.empty()) {
    return;
  }
  hidden_.resetWithout(seen, static_cast<std::uint32_t>(scene_.boxes.objects.size()));
  removeFusedBelow(0, region);
  hidden_.complement(seen);
}

void CellBaker::removeFusedBelow(std::uint32_t number, const CellBox& region) {
  const BoxTreeView boxes = scene_.boxes.view();
  const BoxNode& node = boxes.nodes[number];
  const ObjectRun objects{node.first_object, node.first_object + node.object_count};
  if (hidden_.containsAll(objects)) {
    return;
  }
  const bool hidden = boxes.leaf(number) ? hidesObject(region, node.bounds, boxes.objects[node.first_object])
                                         : hidesBox(region, node.bounds, kNoObject, {});
  if (hidden) {
    recordSurfaces(objects);
    hidden_.add(std::span(&objects, 1));
    return;
  }
  for (std::uint32_t child = number + 1; child < node.end; child = boxes.nodes[child].end) {
    removeFusedBelow(child, region);
  }
}

bool CellBaker::hidesObject(const CellBox& region, const Box& bounds, ObjectId object) {
  const RegionEffort effort{scene_.settings.narrowings, scene_.settings.divisions};
  const std::span<const Box> several = scene_.object_boxes.of(object);
  if (several.empty() || !areBoxesOf(several, bounds)) {
    return hidesBox(region, bounds, object.value, effort);
  }
  if (hidesBox(region, bounds, object.value, {})) {
    return true;
  }
  const bool hidden = std::all_of(several.begin(), several.end(), [&](const Box& box) {
    return hidesBox(region, box, object.value, effort);
  });
  decided_by_ = WitnessKind::kBoxes;
  return hidden;
}

bool CellBaker::hidesBox(const CellBox& region, const Box& box, std::uint32_t object,
                         const RegionEffort& effort) {
  const bool hidden =
      box.wellFormed() && !intersects(region, box) &&
      surfaces_.hides(region, {.box = {Vec3d(box.min), Vec3d(box.max)}, .object = object}, effort);
  decided_by_ = surfaces_.decidedBy();
  return hidden;
}

void CellBaker::recordConvex(std::uint32_t occluder, std::span<const ObjectRun> objects) {
  const ConvexOccluder& convex = scene_.occluders[occluder];
  HidingWitness witness{.kind = WitnessKind::kConvex, .occluder = convex.id.value, .object = convex.object};
  record(std::move(witness), objects);
}

void CellBaker::recordSurfaces(const ObjectRun& objects) {
  HidingWitness witness{.kind = decided_by_};
  if (decided_by_ == WitnessKind::kSurfaces) {
    const FusedOcclusion::Proof& proof = surfaces_.proof();
    witness.object = ObjectId(proof.object);
    witness.from = proof.from;
    witness.to = proof.to;
  }
  record(std::move(witness), std::span(&objects, 1));
}

void CellBaker::record(HidingWitness witness, std::span<const ObjectRun> objects) {
  if (!scene_.settings.witnesses) {
    return;
  }
  witness.cell = cell_;
  witness.part = part_;
  for (const ObjectRun& run : objects) {
    for (std::uint32_t i = run.begin; i < run.end; ++i) {
      if (hidden_.contains(i)) {
        continue;
      }
      if (!witness.hidden.empty() && witness.hidden.back().end == i) {
        witness.hidden.back().end = i + 1;
      } else {
        witness.hidden.push_back({i, i + 1});
      }
    }
  }
  if (!witness.hidden.empty()) {
    witnesses_.push_back(std::move(witness));
  }
}

void CellBaker::forgetSides() {
  const auto other = std::find_if(witnesses_.rbegin(), witnesses_.rend(),
                                  [this](const HidingWitness& witness) { return witness.cell != cell_; });
  witnesses_.erase(
      std::remove_if(other.base(), witnesses_.end(),
                     [](const HidingWitness& witness) { return witness.part != WitnessPart::kWhole; }),
      witnesses_.end());
}

// Skips an occluder whose object is already hidden. Its shadow lies within that of what hides it, from every
// viewpoint, so little is lost: nothing where one of these occluders does.
void CellBaker::removeHiddenFrom(std::span<const Vec3d> corners, WitnessPart part, Runs& seen) {
  part_ = part;
  if (corners.empty()) {
    seen.clear();  // there are no viewers
    return;
  }
  hidden_.resetWithout(seen, static_cast<std::uint32_t>(scene_.boxes.objects.size()));
  std::vector<Sample*> samples;
  for (const Vec3d& corner : corners) {
    samples.push_back(&samples_.at(corner));
  }
  for (const std::uint32_t i : chosen_) {
    const ConvexOccluder& occluder = scene_.occluders[i];
    if (!hidden_.contains(scene_.position_of[occluder.object.value]) &&
        separated(scene_.occluders, occluder, corners, scene_.settings.near_distance) &&
        intersectOverCorners(i, samples)) {
      recordConvex(i, common_);
      hidden_.add(common_);
    }
  }
  hidden_.complement(seen);
}

// Fills common_ with the runs that this one occluder hides from all corners. The intersection over the
// corners must be taken per occluder, and only then the union over all occluders: two occluders that hide an
// object from some corners each may leave it visible from a point in between. Returns false if common_ is
// empty.
bool CellBaker::intersectOverCorners(std::uint32_t occluder, std::span<Sample* const> corners) {
  const std::span<const ObjectRun> first = samples_.hidden(*corners[0], occluder);
  common_.assign(first.begin(), first.end());
  for (std::size_t i = 1; i < corners.size() && !common_.empty(); ++i) {
    intersect(common_, samples_.hidden(*corners[i], occluder), scratch_);
    common_.swap(scratch_);
  }
  return !common_.empty();
}

std::uint64_t trianglesOf(const BakeScene& scene, const CellSets& sets) {
  return sets.plane ? std::max(scene.triangles.of(sets.front), scene.triangles.of(sets.back))
                    : scene.triangles.of(sets.whole);
}

std::uint64_t CellBaker::trianglesSeenFrom(const Vec3d& eye) {
  hidden_.reset(static_cast<std::uint32_t>(scene_.boxes.objects.size()));
  Sample& sample = samples_.at(eye);
  for (const std::uint32_t i : chosen_) {
    const ConvexOccluder& occluder = scene_.occluders[i];
    if (!hidden_.contains(scene_.position_of[occluder.object.value]) &&
        separated(scene_.occluders, occluder, std::span(&eye, 1), scene_.settings.near_distance)) {
      hidden_.add(samples_.hidden(sample, i));
    }
  }
  hidden_.complement(scratch_);
  return scene_.triangles.of(scratch_);
}

double CellBaker::shareSeenFrom(const Vec3d& point, const Runs& seen) {
  constexpr std::uint64_t kObjects = 128;  // that are asked about
  constexpr int kLines = 3;                // to each
  std::uint64_t count = 0, at = 0;
  for (const ObjectRun& run : seen) {
    count += run.end - run.begin;
  }
  const std::uint64_t step = count / kObjects + 1;
  double all = 0.0, clear = 0.0;
  std::uint32_t random = 1;
  for (const ObjectRun& run : seen) {
    for (std::uint64_t i = (step - at % step) % step; i < run.end - run.begin; i += step) {
      const auto position = static_cast<std::uint32_t>(run.begin + i);
      const BoxNode& leaf = scene_.leafOf(position);
      all += leaf.triangles;
      for (int line = 0; line < kLines; ++line) {
        Vec3d to(leaf.bounds.min);
        for (int axis = 0; axis < 3; ++axis) {
          random = random * 1664525u + 1013904223u;
          to[axis] += double{leaf.bounds.max[axis] - leaf.bounds.min[axis]} * (random >> 8) * 0x1p-24;
        }
        if (surfaces_.isClear(point, to)) {
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
  const CellBox box = scene_.boxOf(cell);
  chooseOccluders(cell, search_distance, scene_.settings.max_depth);
  std::vector<Vec3d> points{box.centre()};
  for (std::uint32_t i = 0; i < 8; ++i) {
    points.push_back(scene_.boxOf(cell.child(i)).centre());
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
    return static_cast<double>(trianglesSeenFrom(point)) <
           (1.0 - scene_.settings.similarity) * cell_triangles;
  });
}

}  // namespace sightline::pvs
