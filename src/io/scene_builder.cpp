#include "src/io/scene_builder.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sightline::io {
namespace {

struct Bounds {
  Vec3d min, max;
};

Bounds boundsOf(const std::vector<Vec3d>& positions) {
  Bounds bounds{positions.front(), positions.front()};
  for (const Vec3d& position : positions) {
    bounds.min = min(bounds.min, position);
    bounds.max = max(bounds.max, position);
  }
  return bounds;
}

// Beyond 8 km a float's steps reach a millimetre. Moving the scene is worth it where it wins at least one
// bit.
Vec3d chooseOrigin(const Bounds& bounds) {
  constexpr double kMillimetreReach = 8192.0;
  const Vec3d middle = (bounds.min + bounds.max) * 0.5;
  const double reach = std::max(maxComponent(abs(bounds.min)), maxComponent(abs(bounds.max)));
  const double reach_after = maxComponent((bounds.max - bounds.min) * 0.5);
  if (reach < kMillimetreReach || reach_after > 0.5 * reach) {
    return {};
  }
  return {std::round(middle.x), std::round(middle.y), std::round(middle.z)};
}

// The far plane that leaves nothing of the scene out, for cameras that state none.
void setUnstatedFarPlane(CameraPath& path, const Bounds& bounds) {
  double far = 2.0 * path.z_near;
  for (const CameraFrame& frame : path.frames) {
    const Vec3d reach = max(abs(bounds.min - frame.eye), abs(bounds.max - frame.eye));
    far = std::max(far, 1.01 * length(reach));
  }
  path.z_far = far;
}

}  // namespace

MaterialId SceneBuilder::addMaterial(Material material) {
  scene_.materials.push_back(std::move(material));
  return MaterialId(scene_.materials.size() - 1);
}

// An object that would have no triangle keeps them.
void SceneBuilder::addUncertain() {
  if (uncertain_.empty()) {
    return;
  }
  std::vector<std::uint32_t> corners = std::exchange(uncertain_, {});
  if (scene_.objects.back().index_count > 0) {
    beginObject(scene_.object_names.back() + "/uncertain", scene_.objects.back().material,
                OccluderMark::kNever);
  }
  scene_.objects.back().mark = OccluderMark::kNever;
  scene_.objects.back().index_count = static_cast<std::uint32_t>(corners.size());
  scene_.indices.insert(scene_.indices.end(), corners.begin(), corners.end());
}

void SceneBuilder::beginObject(std::string name, MaterialId material, OccluderMark mark) {
  addUncertain();
  Object object;
  object.first_index = static_cast<std::uint32_t>(scene_.indices.size());
  object.material = material;
  object.mark = mark;
  scene_.objects.push_back(object);
  scene_.object_names.push_back(std::move(name));
}

std::uint32_t SceneBuilder::addVertex(const Vec3d& position_world) {
  positions_world_.push_back(position_world);
  return static_cast<std::uint32_t>(positions_world_.size() - 1);
}

void SceneBuilder::addTriangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, bool certain) {
  if (!certain) {
    uncertain_.insert(uncertain_.end(), {a, b, c});
    return;
  }
  scene_.indices.insert(scene_.indices.end(), {a, b, c});
  scene_.objects.back().index_count += 3;
}

Scene SceneBuilder::finish() {
  addUncertain();
  if (!positions_world_.empty()) {
    const Bounds bounds = boundsOf(positions_world_);
    scene_.origin = chooseOrigin(bounds);
    scene_.positions.reserve(positions_world_.size());
    for (const Vec3d& position : positions_world_) {
      scene_.positions.push_back(Vec3f(position - scene_.origin));
    }
    std::vector<Vec3d>().swap(positions_world_);  // frees it, which no assignment of {} does
    for (CameraPath& path : scene_.paths) {
      if (path.z_far == 0.0) {
        setUnstatedFarPlane(path, bounds);
      }
    }
  }
  for (CameraPath& path : scene_.paths) {
    if (path.z_far == 0.0) {
      path.z_far = std::max(2000.0, 2.0 * path.z_near);
    }
  }
  weldPositions(scene_);
  updateBounds(scene_);
  return std::exchange(scene_, Scene{});
}

}  // namespace sightline::io
