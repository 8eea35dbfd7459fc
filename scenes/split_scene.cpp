#include "scenes/split_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

namespace sightline {
namespace {

// The axes along which a box is wider than a cell.
std::vector<SplitAxis> axesOf(const Box& box, double width) {
  std::vector<SplitAxis> axes;
  double cells = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = box.min[axis], high = box.max[axis];
    const double count = std::ceil((high - low) / width);
    if (count > 1.0) {
      Vec3d direction;
      direction[axis] = 1.0;
      cells *= count;
      axes.push_back(
          {direction, low, high, static_cast<std::uint32_t>(std::min<double>(count, kMostSplitCells))});
    }
  }
  return cells > kMostSplitCells ? axesOf(box, 2.0 * width) : axes;
}

SplitMesh splitObject(const SceneView& scene, const Object& object, std::span<const SplitAxis> axes,
                      double inflation) {
  std::vector<Vec3d> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles(object.triangleCount());
  for (const std::uint32_t index : scene.indicesOf(object)) {
    triangles[positions.size() / 3][positions.size() % 3] = static_cast<std::uint32_t>(positions.size());
    positions.emplace_back(scene.positions[index]);
  }
  return splitMesh(positions, triangles, gridCells(axes), inflation);
}

// Adds an object with the material and the mark of another one.
void addObject(const Object& like, std::string name, std::span<const Vec3f> positions,
               std::span<const std::uint32_t> indices, Scene& scene) {
  Object object = like;
  object.first_index = static_cast<std::uint32_t>(scene.indices.size());
  object.index_count = static_cast<std::uint32_t>(indices.size());
  object.bounds = {};
  for (const std::uint32_t index : indices) {
    scene.indices.push_back(static_cast<std::uint32_t>(scene.positions.size()));
    scene.positions.push_back(positions[index]);
    object.bounds.extend(positions[index]);
  }
  scene.objects.push_back(object);
  scene.object_names.push_back(std::move(name));
}

// Adds the pieces of an object, and the planes between them. Adds nothing if all pieces collapse.
void addPieces(const Object& object, const std::string& name, const SplitMesh& split, SplitScene& result) {
  constexpr std::uint32_t kNone = 0xffffffffu;
  std::vector<std::uint32_t> part_of;
  for (const SplitPiece& piece : split.pieces) {
    const Scene mesh = pieceMesh(piece);
    part_of.push_back(mesh.indices.empty() ? kNone : static_cast<std::uint32_t>(result.scene.objects.size()));
    if (!mesh.indices.empty()) {
      addObject(object, name + ", cell " + std::to_string(piece.cell), mesh.positions, mesh.indices,
                result.scene);
    }
  }
  for (const SplitNeighbours& neighbours : split.neighbours) {
    if (part_of[neighbours.first] != kNone && part_of[neighbours.second] != kNone) {
      result.planes.push_back({part_of[neighbours.first], part_of[neighbours.second], neighbours.rule});
    }
  }
}

}  // namespace

Scene pieceMesh(const SplitPiece& piece) {
  Scene mesh;
  for (const SplitTriangle& triangle : piece.triangles) {
    const Vec3f a(triangle.positions[0]), b(triangle.positions[1]), c(triangle.positions[2]);
    if (a == b || b == c || c == a) {
      continue;
    }
    for (const Vec3f& corner : {a, b, c}) {
      mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
      mesh.positions.push_back(corner);
    }
  }
  weldPositions(mesh);
  return mesh;
}

SplitScene splitScene(const Scene& scene, double width, double inflation, const Progress& progress) {
  SplitScene result;
  result.scene.materials = scene.materials;
  result.scene.paths = scene.paths;
  result.scene.origin = scene.origin;
  const SceneView view = scene.view();
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const Object& object = scene.objects[i];
    const std::vector<SplitAxis> axes = axesOf(object.bounds, width);
    const std::size_t before = result.scene.objects.size();
    if (!axes.empty() && view.materialOf(object).opacity != Opacity::kBlended) {
      addPieces(object, scene.object_names[i], splitObject(view, object, axes, inflation), result);
    }
    if (result.scene.objects.size() == before) {
      addObject(object, scene.object_names[i], scene.positions, view.indicesOf(object), result.scene);
    }
    if (progress) {
      progress(static_cast<double>(i + 1) / static_cast<double>(scene.objects.size()));
    }
  }
  weldPositions(result.scene);
  return result;
}

}  // namespace sightline
