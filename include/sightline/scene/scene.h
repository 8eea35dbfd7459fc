#pragma once

// A scene as all parts of Sightline use it: triangles in objects with materials.
//
// Positions are single precision in scene space: world space moved by Scene::origin (double precision), so
// that a city in national grid coordinates keeps its millimetres. These stored floats are exact by
// definition: they are drawn, they occlude, and rays are cast against them.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sightline/base/ids.h"
#include "sightline/math/box.h"
#include "sightline/scene/camera.h"
#include "sightline/scene/material.h"

namespace sightline {

// The scene author's choice about an object's use as an occluder.
enum class OccluderMark : std::uint8_t {
  kAutomatic,  // no choice: Sightline decides by material and size
  kOccluder,   // use it, however small, if its material is opaque
  kNever,      // never use it
};

// One drawable unit, the occludee: a (node, primitive) pair of the scene file.
struct Object {
  std::uint32_t first_index = 0;  // into Scene::indices
  std::uint32_t index_count = 0;  // three per triangle
  MaterialId material{};          // must be set: see SceneView
  OccluderMark mark = OccluderMark::kAutomatic;
  Box bounds{};  // of its vertices, scene space; may be wider, as in a ClosedScene

  std::uint32_t triangleCount() const { return index_count / 3; }
};

// Views of the caller's own memory, all in scene space: the input of the library's functions.
//
// The front of a triangle (a, b, c) is the side to which cross(b - a, c - a) points. In a left-handed space
// that is the side from which it appears clockwise: reverse the order of vertices if your fronts are
// counter-clockwise there.
//
// Preconditions of all functions that take a SceneView, none of which checks them; checkScene() does:
// - every index of an object is below positions.size();
// - of every object, first_index + index_count is at most indices.size(), and index_count a multiple of 3;
// - every object's material is valid and below materials.size(): a default Object has none;
// - every object's bounds hold all of its vertices, or are empty where one is not finite (updateBounds()).
struct SceneView {
  std::span<const Vec3f> positions{};
  std::span<const std::uint32_t> indices{};  // into positions
  std::span<const Object> objects{};         // ObjectId is the index here
  std::span<const Material> materials{};     // MaterialId is the index here

  std::span<const std::uint32_t> indicesOf(const Object& object) const {
    return indices.subspan(object.first_index, object.index_count);
  }
  const Material& materialOf(const Object& object) const { return materials[object.material.value]; }
};

// A scene that owns its memory. Equal positions are stored once (see weldPositions).
struct Scene {
  std::vector<Vec3f> positions{};
  std::vector<std::uint32_t> indices{};
  std::vector<Object> objects{};
  std::vector<Material> materials{};
  std::vector<std::string> object_names{};  // one per object
  std::vector<CameraPath> paths{};          // of the file's cameras or of the procedural scene, world space
  Vec3d origin{};                           // position of the origin of scene space, world space
  std::vector<std::string> notes{};         // what the importer has to say to the user, a line each

  SceneView view() const { return {positions, indices, objects, materials}; }
  std::uint64_t triangleCount() const { return indices.size() / 3; }
};

// The box around all objects that have a finite one, in scene space; empty if none has.
Box sceneBounds(const SceneView& scene);

// Stores positions that are bitwise equal (with -0 as 0) once and renumbers the indices. Removes unused
// positions.
void weldPositions(Scene& scene);

// Sets Object::bounds from the triangles, whose numbers are in range (see SceneView). An object with a vertex
// that is not finite gets an empty box: it is never culled.
void updateBounds(std::span<const Vec3f> positions, std::span<const std::uint32_t> indices,
                  std::span<Object> objects);
void updateBounds(Scene& scene);

}  // namespace sightline
