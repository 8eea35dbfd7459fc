#include "pvs/bake/bake_scene.h"

#include <algorithm>

namespace sightline::bake_detail {
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

// Calls visit(number of the box) for all boxes that meet this one, ascending.
template <typename Visit>
void forEachMeeting(const BoxTree& tree, const CellBox& box, Visit&& visit) {
  for (std::uint32_t n = 0; n < tree.nodes.size();) {
    const BoxNode& node = tree.nodes[n];
    if (!meet(box, node.bounds)) {
      n = node.end;
      continue;
    }
    if (node.end == n + 1) {
      visit(tree.objects[node.first_object].value);
    }
    n += 1;
  }
}

// The cube that begins where the box does, on every axis a little wider than its longest edge.
CellBox cubeAround(const CellBox& box) {
  const double reach = maxComponent(max(abs(box.min), abs(box.max)));
  const double edge = std::max({maxComponent(box.extent()), 0x1p-20 * reach, 1e-6}) * (1.0 + 0x1p-20);
  return {box.min, box.min + Vec3d{edge, edge, edge}};
}

// Of the smallest box around this one and all objects with a box.
double diagonalOf(const SceneView& scene, const CellBox& box) {
  Vec3d low = box.min, high = box.max;
  for (const Object& object : scene.objects) {
    if (object.bounds.wellFormed()) {
      low = min(low, Vec3d(object.bounds.min));
      high = max(high, Vec3d(object.bounds.max));
    }
  }
  return length(high - low);
}

}  // namespace

BakeScene::BakeScene(const SceneView& scene, const OccluderSet& set, const BakeSettings& s,
                     const CellBox& viewers)
    : settings(s),
      region(viewers),
      root(cubeAround(viewers)),
      boxes(buildBoxTree(boundsOf(scene), trianglesOf(scene))),
      shadow_tree(boxes.view()),
      triangles(boxes.view()),
      position_of(scene.objects.size()),
      occluders(set),
      side_margin(sideMargin(root)),
      diagonal(diagonalOf(scene, region)),
      reach(1.01 * diagonalOf(scene, root)) {
  for (std::uint32_t i = 0; i < boxes.objects.size(); ++i) {
    position_of[boxes.objects[i].value] = i;
  }
  for (std::uint32_t level = 0; level <= settings.max_depth; ++level) {
    levels_.push_back(occludersFor(level));
  }
  face_edges_.reserve(set.vertices.size());
  std::vector<Box> bounds;
  for (const Occluder& occluder : set.occluders) {
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

BakeScene::LevelOccluders BakeScene::occludersFor(std::uint32_t level) const {
  const CellBox cell = boxOf({level, {}});
  const Vec3d extent = cell.extent();
  const double least_area = settings.occluder_size * cell.smallestFace();
  const double least_volume = settings.occluder_size * extent.x * extent.y * extent.z;
  LevelOccluders found;
  std::vector<Box> bounds;
  for (std::uint32_t i = 0; i < occluders.size(); ++i) {
    if (occluders[i].area >= least_area || occluders[i].volume >= least_volume) {
      found.occluders.push_back(i);
      bounds.push_back(occluders[i].bounds);
    }
  }
  found.tree = buildBoxTree(bounds, {});
  return found;
}

void BakeScene::findOccluders(const CellBox& box, std::uint32_t level,
                              std::vector<std::uint32_t>& found) const {
  const LevelOccluders& at_level = levels_[level];
  const auto before = static_cast<std::ptrdiff_t>(found.size());
  forEachMeeting(at_level.tree, box, [&](std::uint32_t i) { found.push_back(at_level.occluders[i]); });
  std::sort(found.begin() + before, found.end());
}

void BakeScene::findFaces(const CellBox& box, std::vector<DividingFace>& found) const {
  std::vector<std::uint32_t> numbers;
  forEachMeeting(face_tree_, box, [&](std::uint32_t i) { numbers.push_back(i); });
  std::sort(numbers.begin(), numbers.end());
  for (const std::uint32_t i : numbers) {
    found.push_back(faces_[i]);
  }
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

}  // namespace sightline::bake_detail
