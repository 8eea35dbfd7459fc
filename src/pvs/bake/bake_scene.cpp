#include "src/pvs/bake/bake_scene.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "src/pvs/bake/box_search.h"

namespace sightline::pvs {
namespace {

std::vector<Box> boundsOf(const SceneView& scene) {
  std::vector<Box> bounds;
  for (const Object& object : scene.objects) {
    bounds.push_back(object.bounds);
  }
  return bounds;
}

std::vector<std::uint32_t> trianglesOf(const SceneView& scene) {
  std::vector<std::uint32_t> triangles;
  for (const Object& object : scene.objects) {
    triangles.push_back(object.triangleCount());
  }
  return triangles;
}

// True if test(index of the box) holds for one of the boxes that intersect this one. Stops at the first.
template <typename Test>
bool anyIntersecting(const BoxTree& tree, const CellBox& box, Test&& test) {
  return anyLeaf(
      tree.view(), [&](const Box& bounds) { return !intersects(box, bounds); },
      [&](const BoxNode& leaf) { return test(tree.objects[leaf.first_object].value); });
}

// Calls visit(index of the box) for all boxes that intersect this one.
template <typename Visit>
void forEachIntersecting(const BoxTree& tree, const CellBox& box, Visit&& visit) {
  anyIntersecting(tree, box, [&](std::uint32_t i) {
    visit(i);
    return false;
  });
}

// A cube with the box's minimum corner, slightly wider on every axis than the box's longest edge.
CellBox cubeAround(const CellBox& box) {
  const double reach = maxComponent(max(abs(box.min), abs(box.max)));
  const double edge = std::max({maxComponent(box.extent()), 0x1p-20 * reach, 1e-6}) * (1.0 + 0x1p-20);
  return {box.min, box.min + Vec3d{edge, edge, edge}};
}

// Diagonal of the smallest box around this one and all objects that have a box.
double diagonalOf(const SceneView& scene, const CellBox& box) {
  Vec3d low = box.min, high = box.max;
  if (const Box all = sceneBounds(scene); !all.empty()) {
    low = min(low, Vec3d(all.min));
    high = max(high, Vec3d(all.max));
  }
  return length(high - low);
}

// True if the occluder is large enough for cells of this size.
bool isOfUse(const ConvexOccluder& occluder, const CellBox& cell, double occluder_size) {
  const Vec3d extent = cell.extent();
  return occluder.area >= occluder_size * cell.smallestFace() ||
         occluder.volume >= occluder_size * extent.x * extent.y * extent.z;
}

double magnitudeOf(const CellBox& root, const BoxTree& boxes) {
  double magnitude = maxComponent(max(abs(root.min), abs(root.max)));
  for (const BoxNode& node : boxes.nodes) {
    if (node.bounds.wellFormed()) {
      magnitude =
          std::max(magnitude, maxComponent(max(abs(Vec3d(node.bounds.min)), abs(Vec3d(node.bounds.max)))));
    }
  }
  return magnitude;
}

// A box around the cell and all boxes, rounded outwards.
Box frameOf(const CellBox& cell, std::span<const Box> boxes) {
  Box frame;
  for (const Vec3d& corner : {cell.min, cell.max}) {
    frame.extend(Vec3f(corner));
  }
  frame = widened(frame, 0x1p-20 * maxComponent(max(abs(cell.min), abs(cell.max))));
  for (const Box& box : boxes) {
    frame.extend(box);
  }
  return frame;
}

constexpr std::size_t kDefaultSampleBytes = 256u << 20;

// Limits of a chosen depth: its minimum, and the maximum number of cells beyond that.
struct DepthLimits {
  std::uint32_t min_depth = 0;
  std::uint64_t max_cells = 0;
};
constexpr DepthLimits kConvexLimits{6, 1u << 15};
// A cell takes some fifty times as long where surfaces hide as well.
constexpr DepthLimits kFusedLimits{3, 1u << 11};
constexpr std::uint32_t kLargeInLevels = 3;  // at most the minimum depths
// Minimum edge of a cell in near distances. In smaller cells, the closest occluders would no longer count.
constexpr double kMinEdgeInNears = 4.0;
// Detects the region's floor, ceiling and outer walls, which hide nothing inside the region. In fractions of
// the region's extent.
constexpr double kSpans = 0.9, kTouches = 1e-3, kThin = 0.125;

// Bounds of viewers begin and end at every fourth step of a cell only, so that those of cells that were
// merged do too, twice over, and neighbours share corners.
constexpr std::uint32_t kBoundSteps = 4;

bool isBorder(const Box& box, const CellBox& region) {
  const Vec3d all = region.extent(), min(box.min), max(box.max);
  const auto spans = [&](int axis) { return max[axis] - min[axis] >= kSpans * all[axis]; };
  const auto touches = [&](int axis) {
    return max[axis] - min[axis] <= kThin * all[axis] &&
           std::min(min[axis] - region.min[axis], region.max[axis] - max[axis]) <= kTouches * all[axis];
  };
  return (touches(0) && spans(1) && spans(2)) || (touches(1) && spans(2) && spans(0)) ||
         (touches(2) && spans(0) && spans(1));
}

bool anyIntersecting(const BoxTree& tree, const CellBox& box) {
  return anyIntersecting(tree, box, [](std::uint32_t) { return true; });
}

// The box around all of these, of which one at least is finite and not empty.
CellBox regionAround(std::span<const Box> boxes) {
  Box around;
  for (const Box& box : boxes) {
    around.extend(box);
  }
  return {Vec3d(around.min), Vec3d(around.max)};
}

// Number of cells of a level below `cell` for whose boxes, and for those of all cells above them, test(box)
// holds. Counting stops at the limit.
template <typename Test>
std::uint64_t countCells(const CellBox& root, const OctreeCell& cell, std::uint32_t level,
                         std::uint64_t limit, const Test& test) {
  if (!test(CellBox{cellMin(root.min, root.max, cell), cellMax(root.min, root.max, cell)})) {
    return 0;
  }
  if (cell.level == level) {
    return 1;
  }
  std::uint64_t count = 0;
  for (std::uint32_t i = 0; i < 8 && count < limit; ++i) {
    count += countCells(root, cell.child(i), level, limit - count, test);
  }
  return count;
}

// The surfaces while these doors are closed and all others are open.
Panels panelsOf(const SceneView& scene, const DoorGroups& doors, std::span<const ObjectId> closed,
                const BakeSettings& settings, const ParallelFor& parallel_for) {
  const std::vector<Object> objects = withClosed(scene, doors, closed);
  const std::uint32_t most_sheets = isThorough(settings) ? kSmallPanel : kLargePanel;
  return findPanels({scene.positions, scene.indices, objects, scene.materials}, most_sheets, parallel_for);
}

}  // namespace

BakeScene::BakeScene(const SceneView& scene, const OccluderSet& set, const BakeSettings& s,
                     const ParallelFor& parallel_for)
    : settings(s),
      doors(doorGroupsOf(s.doors)),
      region(regionAround(s.viewers)),
      root(cubeAround(region)),
      reach(1.01 * diagonalOf(scene, root)),
      boxes(buildBoxTree(boundsOf(scene), trianglesOf(scene))),
      magnitude(magnitudeOf(root, boxes)),
      shadow_tree(boxes.view(), reach),
      triangles(boxes.view()),
      position_of(scene.objects.size()),
      occluders(set),
      panels(s.occlusion == BakeOcclusion::kFused ? panelsOf(scene, doors, {}, s, parallel_for) : Panels{}),
      frame(frameOf(root, panels.bounds)),
      object_boxes(
          s.occlusion == BakeOcclusion::kFused
              ? findObjectBoxes(scene, {.max_boxes = s.object_boxes, .margin = s.box_margin}, parallel_for)
              : ObjectBoxes{}),
      side_margin(sideMargin(root)),
      diagonal(diagonalOf(scene, region)),
      viewer_tree_(buildBoxTree(s.viewers, {})) {
  numberObjects();
  if (settings.occlusion == BakeOcclusion::kFused) {
    for (const std::vector<ObjectId>& group : doors.groups) {
      closed_panels.push_back(panelsOf(scene, doors, group, settings, parallel_for));
    }
  }
  numberOccluders();
  chooseDepth();
  countOccluders();
  gatherLevels(set, parallel_for);
}

void BakeScene::numberObjects() {
  for (std::uint32_t i = 0; i < boxes.objects.size(); ++i) {
    position_of[boxes.objects[i].value] = i;
  }
  for (const ObjectId door : doors.all) {
    const ObjectRun run{position_of[door.value], position_of[door.value] + 1};
    Runs more;
    unite(door_runs, std::span(&run, 1), more);
    door_runs.swap(more);
  }
  leaf_of_.resize(boxes.objects.size());
  for (std::uint32_t n = 0; n < boxes.nodes.size(); ++n) {
    if (boxes.view().leaf(n)) {
      leaf_of_[boxes.nodes[n].first_object] = n;
    }
  }
}

void BakeScene::numberOccluders() {
  door_occluders_.resize(doors.all.size());
  for (std::uint32_t i = 0; i < occluders.size(); ++i) {
    position_of_occluder.push_back(position_of[occluders[i].object.value]);
    if (doors.isDoor(occluders[i].object)) {
      door_occluders_[indexOf(occluders[i].object)].push_back(i);
    }
  }
}

void BakeScene::gatherLevels(const OccluderSet& set, const ParallelFor& parallel_for) {
  // The trees of the levels and that of the faces, side by side.
  const std::uint32_t levels = settings.max_depth + 1;
  levels_.resize(levels);
  parallel_for(levels + 1, [&](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t i = begin; i < end; ++i) {
      i < levels ? void(levels_[i] = occludersFor(i)) : gatherFaces(set);
    }
  });
  levels_of_use_.resize(occluders.size());
  for (std::uint32_t level = 0; level < levels; ++level) {
    for (const std::uint32_t i : levels_[level].occluders) {
      levels_of_use_[i] |= 1u << level;
    }
  }
}

void BakeScene::gatherFaces(const OccluderSet& set) {
  face_edges_.reserve(set.vertices.size());
  std::vector<Box> bounds;
  for (const Occluder& occluder : set.occluders) {
    if (doors.isDoor(occluder.object)) {
      continue;
    }
    const std::span<const Vec3f> vertices = set.verticesOf(occluder);
    const std::size_t first = face_edges_.size();
    Box box;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      face_edges_.push_back({Vec3d(vertices[i]), Vec3d(vertices[(i + 1) % vertices.size()])});
      box.extend(vertices[i]);
    }
    faces_.push_back({occluder.plane, std::span(face_edges_).subspan(first, vertices.size()),
                      2.0 * occluder.slack, occluder.double_sided});
    bounds.push_back(box);
  }
  face_tree_ = buildBoxTree(bounds, {});
}

// Chooses the base depth, with cells as small as possible while they are not too many; then a greater depth
// for cells near an occluder, while those are not too many.
void BakeScene::chooseDepth() {
  base_depth_ = settings.max_depth;
  if (settings.max_depth != BakeSettings::kChooseDepth) {
    return;
  }
  const auto small = [&](std::uint32_t level) {
    return boxOf({level, {}}).extent().x < kMinEdgeInNears * settings.near_distance;
  };
  const auto [min_depth, max_cells] =
      settings.occlusion == BakeOcclusion::kFused ? kFusedLimits : kConvexLimits;
  base_depth_ = min_depth;
  while (base_depth_ < kMaxOctreeDepth && !small(base_depth_ + 1) &&
         countCells(root, {}, base_depth_ + 1, max_cells + 1,
                    [&](const CellBox& box) { return holdsViewers(box); }) <= max_cells) {
    ++base_depth_;
  }
  settings.max_depth = base_depth_;
  for (std::uint32_t level = base_depth_ + 1; level <= kMaxOctreeDepth && !small(level); ++level) {
    BoxTree near = reachOfOccluders(level);
    const std::uint64_t count = countCells(root, {}, level, max_cells + 1, [&](const CellBox& box) {
      return holdsViewers(box) && anyIntersecting(near, box);
    });
    if (count > max_cells) {
      break;
    }
    if (count > 0) {
      settings.max_depth = level;
      reach_tree_ = std::move(near);
    }
  }
}

// The boxes within which occluders count as near, for cells of the level. An occluder hides little from
// farther away than its own size. Occluders that are not useful to cells of the level are omitted, and so are
// those useful to much larger cells, such as the ground.
BoxTree BakeScene::reachOfOccluders(std::uint32_t level) const {
  std::vector<Box> reached;
  for (std::uint32_t i = 0; i < occluders.size(); ++i) {
    const ConvexOccluder& occluder = occluders[i];
    if (ofUse(occluder, level) && !ofUse(occluder, level - kLargeInLevels)) {
      const auto far = static_cast<float>(std::sqrt(occluder.area));
      reached.push_back(
          {occluder.bounds.min - Vec3f(far, far, far), occluder.bounds.max + Vec3f(far, far, far)});
    }
  }
  return buildBoxTree(reached, {});
}

void BakeScene::countOccluders() {
  for (std::uint32_t i = 0; i < occluders.size(); ++i) {
    if (doors.isDoor(occluders[i].object)) {
      continue;
    }
    counts.all += 1;
    if (!isBorder(occluders[i].bounds, region)) {
      counts.inner += 1;
      counts.of_use += ofUse(occluders[i], settings.max_depth) ? 1 : 0;
      counts.largest_area = std::max(counts.largest_area, occluders[i].area);
    }
  }
}

std::size_t BakeScene::sampleBytes() const {
  return settings.sample_bytes.value_or(hasManyObjects() ? 0 : kDefaultSampleBytes);
}

bool BakeScene::mayDivide(const OctreeCell& cell) const {
  return cell.level < base_depth_ ||
         (cell.level < settings.max_depth && anyIntersecting(reach_tree_, boxOf(cell)));
}

std::uint64_t BakeScene::mostLeaves(const OctreeCell& cell, std::uint64_t most) const {
  if (!holdsViewers(boxOf(cell))) {
    return 0;
  }
  if (!mayDivide(cell)) {
    return 1;
  }
  std::uint64_t count = 0;
  for (std::uint32_t i = 0; i < 8 && count < most; ++i) {
    count += mostLeaves(cell.child(i), most - count);
  }
  return count;
}

bool BakeScene::holdsViewers(const CellBox& box) const {
  return anyIntersecting(viewer_tree_, box);
}

ViewerBounds BakeScene::viewersIn(const OctreeCell& cell) const {
  if (settings.whole_cells) {
    return {};
  }
  const CellBox all = boxOf(cell);
  CellBox part{all.max, all.min};
  forEachIntersecting(viewer_tree_, all, [&](std::uint32_t i) {
    const Box& box = settings.viewers[i];
    part = {min(part.min, max(all.min, Vec3d(box.min))), max(part.max, min(all.max, Vec3d(box.max)))};
  });
  ViewerBounds viewers;
  constexpr std::uint32_t kSteps = 1u << kViewerLevels;
  for (std::size_t a = 0; a < 3; ++a) {
    const int axis = static_cast<int>(a);
    const auto line = [&](std::uint32_t step) {
      return gridLine(root.min[axis], root.max[axis], cell.level + kViewerLevels,
                      (cell.at[a] << kViewerLevels) + step);
    };
    // A step that viewers only touch counts as well: so does a child that they only touch, and it must lie
    // within its parent's box.
    std::uint32_t first = 0, end = kSteps;
    while (first + kBoundSteps < kSteps && line(first + kBoundSteps) < part.min[axis]) {
      first += kBoundSteps;
    }
    while (end > first + kBoundSteps && line(end - kBoundSteps) > part.max[axis]) {
      end -= kBoundSteps;
    }
    viewers.first[a] = static_cast<std::uint8_t>(first);
    viewers.last[a] = static_cast<std::uint8_t>(end - 1);
  }
  return viewers;
}

CellBox BakeScene::regionOf(const OctreeCell& cell) const {
  const ViewerBounds viewers = viewersIn(cell);
  return {viewersMin(root.min, root.max, cell, viewers), viewersMax(root.min, root.max, cell, viewers)};
}

bool BakeScene::ofUse(const ConvexOccluder& occluder, std::uint32_t level) const {
  return isOfUse(occluder, boxOf({level, {}}), settings.occluder_size) && !doors.isDoor(occluder.object);
}

std::size_t BakeScene::indexOf(ObjectId door) const {
  return static_cast<std::size_t>(std::lower_bound(doors.all.begin(), doors.all.end(), door) -
                                  doors.all.begin());
}

std::span<const std::uint32_t> BakeScene::occludersOfDoor(ObjectId door) const {
  return door_occluders_[indexOf(door)];
}

BakeScene::LevelOccluders BakeScene::occludersFor(std::uint32_t level) const {
  LevelOccluders found;
  std::vector<Box> bounds;
  for (std::uint32_t i = 0; i < occluders.size(); ++i) {
    if (ofUse(occluders[i], level)) {
      found.occluders.push_back(i);
      bounds.push_back(occluders[i].bounds);
    }
  }
  found.tree = buildBoxTree(bounds, {});
  found.cones = ConeTree(bounds, found.occluders);
  return found;
}

void BakeScene::findOccluders(const CellBox& box, std::uint32_t level,
                              std::vector<std::uint32_t>& found) const {
  const LevelOccluders& at_level = levels_[level];
  const auto before = static_cast<std::ptrdiff_t>(found.size());
  forEachIntersecting(at_level.tree, box, [&](std::uint32_t i) { found.push_back(at_level.occluders[i]); });
  std::sort(found.begin() + before, found.end());
}

void BakeScene::findFaces(const CellBox& box, std::vector<DividingFace>& found) const {
  std::vector<std::uint32_t> numbers;
  forEachIntersecting(face_tree_, box, [&](std::uint32_t i) { numbers.push_back(i); });
  std::sort(numbers.begin(), numbers.end());
  for (const std::uint32_t i : numbers) {
    found.push_back(faces_[i]);
  }
}

bool BakeScene::holdsSmallOccluders(const CellBox& box, std::uint32_t level) const {
  const LevelOccluders& of_any_use = levels_.back();
  return anyIntersecting(of_any_use.tree, box,
                         [&](std::uint32_t i) { return !ofUse(occluders[of_any_use.occluders[i]], level); });
}

bool BakeScene::holdsAllOccluders(const CellBox& box) const {
  const BoxTree& of_any_use = levels_.back().tree;
  if (of_any_use.nodes.empty()) {
    return true;
  }
  const Box& all = of_any_use.nodes[0].bounds;
  return box.min.x <= all.min.x && box.min.y <= all.min.y && box.min.z <= all.min.z &&
         box.max.x >= all.max.x && box.max.y >= all.max.y && box.max.z >= all.max.z;
}

}  // namespace sightline::pvs
