#pragma once

// Procedural scenes with moving parts, which demonstrate visibility sorting.

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/layers/layer_sorter.h"
#include "sightline/layers/pair_rule.h"
#include "sightline/scene/scene.h"

namespace sightline {

struct MovingPart {
  std::string name;
  std::vector<std::uint32_t> hulls;  // indices into MovingScene::hulls
  PartSettings settings;
  std::uint32_t class_of = 0;  // kind of part; index into MovingScene::classes
};

// Two parts separated by a plane of the first one's space.
struct MovingPlane {
  std::uint32_t first = 0, second = 0;
  PairPlane rule;
};

// The first part is a sphere, and the second one a cylinder that stands on it.
struct MovingJoint {
  std::uint32_t first = 0, second = 0;
  SphereCylinderJoint rule;
};

struct MovingScene {
  Scene scene;  // object i is part i as it is in frame 0; paths[0] is the camera's
  std::vector<ConvexHull> hulls;
  std::vector<MovingPart> parts;
  std::vector<MovingPlane> planes;
  std::vector<MovingJoint> joints;
  std::vector<std::string> classes;  // "aircraft", "terrain", ...
  std::uint32_t frames = 250;        // number of frames of paths[0]
  // Writes the rigid world_from_part of all parts in a frame, from each part's own space, in which its hulls
  // are. Frames may be requested in any order.
  std::function<void(std::uint32_t frame, std::span<Mat4> world_from_part)> pose;
};

// A sorter of the scene's parts, with the same indices, and with its planes and joints as rules.
LayerSorter makeSorter(const MovingScene& scene, const LayerSettings& settings);

// Moves the sorter's parts to their poses in a frame; a scene without poses does not move. poses: resized to
// the number of parts.
void pose(const MovingScene& scene, std::uint32_t frame, std::vector<Mat4>& poses, LayerSorter& sorter);

// The rigid scene_from_part of all parts in a frame. Empty for a scene without poses, whose parts are in
// scene space.
void scenePoses(const MovingScene& scene, std::uint32_t frame, std::vector<Mat4>& scene_from_part);

// Poses of the objects in a frame, as LayerRenderer::setTransforms takes them: from the positions stored in
// `scene`, those of frame 0, to scene space. One per object; the identity for objects that have not moved,
// and in a scene without poses.
void placements(const MovingScene& scene, std::uint32_t frame, std::vector<Mat4>& scene_from_stored);

// The whole scene with its positions in a frame, rounded to single precision once. Objects, materials and
// paths are the same; no two objects share a position or an index.
void posedScene(const MovingScene& scene, std::uint32_t frame, Scene& posed);

struct ToothpickOptions {
  std::uint32_t count = 200;
  bool uniform_density = false;  // "ud": scaled by (200 / count)^(1/3); otherwise "us"
  double velocity = 1.0;         // factor for toothpicks and camera
  std::uint32_t seed = 1;
};
// Ellipsoids that tumble in a cube, bounce off its sides and pass through each other, in a frame of 8 spheres
// and 12 cylinders. 250 frames. Source: Snyder, Lengyel, section 12.1. The paper does not give sizes; ours
// reproduce its statistics of components.
MovingScene makeToothpicks(const ToothpickOptions& options);

struct CanyonOptions {
  std::uint32_t grid = 14;  // the terrain is split by grid x grid cells
  double inflation = 0.2;   // overlap of the pieces, as a fraction of a cell's size
  std::uint32_t seed = 1;
};
// Six aircraft with six parts each fly in formation through a winding valley under a sky. The terrain is
// split in advance. 250 frames. Source: section 12.2.
MovingScene makeCanyon(const CanyonOptions& options);

// How many triangles the terrain of makeCanyon(options) has after its split. Nothing else of the scene is
// made, which takes a fraction of the time.
std::size_t canyonTerrainTriangles(const CanyonOptions& options);

// "demo:toothpicks?n=200&scaling=ud", "demo:canyon?grid=14". Any other URL gives false or an error.
bool isMovingDemoUrl(std::string_view url);
Result<MovingScene> makeMovingDemoScene(std::string_view url);

}  // namespace sightline
