#pragma once

// Procedural scenes whose parts move: what visibility sorting is shown with.

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
  std::vector<std::uint32_t> hulls;  // into MovingScene::hulls
  PartSettings settings;
  std::uint32_t class_of = 0;  // what kind of thing: into MovingScene::classes
};

// Two parts that a plane of the first one's space keeps apart.
struct MovingPlane {
  std::uint32_t first = 0, second = 0;
  PairPlane rule;
};

// The first part is a sphere on which the second one, a cylinder, stands.
struct MovingJoint {
  std::uint32_t first = 0, second = 0;
  SphereCylinderJoint rule;
};

struct MovingScene {
  Scene scene;  // object i is part i, where it is in frame 0; paths[0] is the camera's
  std::vector<ConvexHull> hulls;
  std::vector<MovingPart> parts;
  std::vector<MovingPlane> planes;
  std::vector<MovingJoint> joints;
  std::vector<std::string> classes;  // "aircraft", "terrain", ...
  std::uint32_t frames = 250;        // as many as paths[0] has
  // world_from_part of all parts in a frame: of the part's own space, in which its hulls are. Rigid. Any
  // frame, in any order.
  std::function<void(std::uint32_t frame, std::span<Mat4> world_from_part)> pose;
};

// A sorter of the scene's parts, which have its numbers, with its planes and joints.
LayerSorter makeSorter(const MovingScene& scene, const LayerSettings& settings);

// Moves the parts to where they are in a frame; a scene without poses stays. poses: as many as parts
// afterwards.
void pose(const MovingScene& scene, std::uint32_t frame, std::vector<Mat4>& poses, LayerSorter& sorter);

// Where the objects are in a frame: scene space from the positions that `scene` stores, which are those of
// frame 0, as LayerRenderer::setTransforms takes them. One an object afterwards; of what has not moved, and
// in a scene without poses, the identity.
void placements(const MovingScene& scene, std::uint32_t frame, std::vector<Mat4>& scene_from_stored);

// The whole scene with its positions where they are in a frame, rounded to single precision once. Objects,
// materials and paths are the same; no two objects share a position or an index.
void posedScene(const MovingScene& scene, std::uint32_t frame, Scene& posed);

struct ToothpickOptions {
  std::uint32_t count = 200;
  bool uniform_density = false;  // "ud": smaller by (200 / count)^(1/3); else "us"
  double velocity = 1.0;         // of toothpicks and of the camera
  std::uint32_t seed = 1;
};
// Ellipsoids that tumble in a cube, bounce off its sides and pass through each other, in a frame of 8 spheres
// and 12 cylinders. 250 frames. Source: Snyder, Lengyel, section 12.1; the sizes, which it does not give, are
// such that its statistics of components come out.
MovingScene makeToothpicks(const ToothpickOptions& options);

struct CanyonOptions {
  std::uint32_t grid = 14;  // the terrain is split by grid x grid cells
  double inflation = 0.2;   // of a cell's size, by which pieces overlap
  std::uint32_t seed = 1;
};
// Six aircraft of six parts each fly in formation through a winding valley whose terrain is split in advance,
// under a sky. 250 frames. Source: section 12.2.
MovingScene makeCanyon(const CanyonOptions& options);

// "demo:toothpicks?n=200&scaling=ud", "demo:canyon?grid=14". false / an error: another scene.
bool isMovingDemoUrl(std::string_view url);
Result<MovingScene> makeMovingDemoScene(std::string_view url);

}  // namespace sightline
