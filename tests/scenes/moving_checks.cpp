#include "tests/scenes/moving_checks.h"

#include <cmath>
#include <set>
#include <vector>

namespace sightline::scene_checks {
namespace {

bool isRigid(const Mat4& m) {
  const Vec3d x(m(0, 0), m(1, 0), m(2, 0)), y(m(0, 1), m(1, 1), m(2, 1)), z(m(0, 2), m(1, 2), m(2, 2));
  constexpr double kTolerance = 1e-12;
  return std::abs(length(x) - 1.0) < kTolerance && std::abs(length(y) - 1.0) < kTolerance &&
         std::abs(dot(x, y)) < kTolerance && length(cross(x, y) - z) < kTolerance && m(3, 0) == 0.0 &&
         m(3, 1) == 0.0 && m(3, 2) == 0.0 && m(3, 3) == 1.0;
}

std::string whatIsWrongWithPoses(const MovingScene& scene) {
  std::vector<Mat4> first(scene.parts.size()), poses(scene.parts.size());
  scene.pose(0, first);
  for (std::uint32_t f = 0; f < scene.frames; ++f) {
    scene.pose(f, poses);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (!isRigid(poses[i])) {
        return scene.parts[i].name + " is not rigid in frame " + std::to_string(f);
      }
      if (scene.parts[i].settings.is_static && poses[i].m != first[i].m) {
        return scene.parts[i].name + " is static and moves in frame " + std::to_string(f);
      }
    }
  }
  return "";
}

}  // namespace

std::vector<Mat4> posesOf(const MovingScene& scene, std::uint32_t frame) {
  std::vector<Mat4> poses(scene.parts.size());
  scene.pose(frame, poses);
  return poses;
}

Vec3d partFromWorld(const Mat4& world_from_part, const Vec3d& world) {
  const Mat4& m = world_from_part;
  const Vec3d p = world - Vec3d(m(0, 3), m(1, 3), m(2, 3));
  return {dot(p, Vec3d(m(0, 0), m(1, 0), m(2, 0))), dot(p, Vec3d(m(0, 1), m(1, 1), m(2, 1))),
          dot(p, Vec3d(m(0, 2), m(1, 2), m(2, 2)))};
}

std::string whatIsWrongWithParts(const MovingScene& scene) {
  if (scene.parts.size() != scene.scene.objects.size()) {
    return "as many parts as objects";
  }
  for (std::size_t i = 0; i < scene.parts.size(); ++i) {
    const MovingPart& part = scene.parts[i];
    if (part.name != scene.scene.object_names[i] || part.class_of >= scene.classes.size() ||
        part.hulls.empty()) {
      return part.name + ": name, class or hulls";
    }
    for (const std::uint32_t hull : part.hulls) {
      if (hull >= scene.hulls.size()) {
        return part.name + ": a hull that there is not";
      }
    }
  }
  for (const MovingPlane& plane : scene.planes) {
    if (plane.first >= scene.parts.size() || plane.second >= scene.parts.size() ||
        plane.first == plane.second) {
      return "a plane between parts that there are not";
    }
  }
  if (scene.scene.paths.empty() || scene.scene.paths[0].frames.size() != scene.frames) {
    return "the camera's path has as many frames as the scene";
  }
  return whatIsWrongWithPoses(scene);
}

std::string whatSticksOut(const MovingScene& scene) {
  std::vector<Mat4> poses(scene.parts.size());
  scene.pose(0, poses);
  for (std::size_t i = 0; i < scene.parts.size(); ++i) {
    if (scene.parts[i].hulls.size() != 1) {
      continue;
    }
    const ConvexHull& hull = scene.hulls[scene.parts[i].hulls[0]];
    const Object& object = scene.scene.objects[i];
    const auto indices = scene.scene.view().indicesOf(object);
    for (const std::uint32_t index : std::set<std::uint32_t>(indices.begin(), indices.end())) {
      const Vec3d local = partFromWorld(poses[i], Vec3d(scene.scene.positions[index]));
      for (const Plane& face : hull.faces) {
        // The tolerance covers rounding in double precision for scenes of up to a kilometre.
        if (face.evaluate(local) > hull.slack + 1e-11) {
          return scene.parts[i].name + " by " + std::to_string(face.evaluate(local) * 1e9) + " nm";
        }
      }
    }
  }
  return "";
}

std::string whatIsOutOfView(const MovingScene& scene, std::uint32_t frame, const View& view) {
  std::vector<Mat4> poses(scene.parts.size());
  scene.pose(frame, poses);
  const Frustum frustum = frustumOf(view);
  for (std::size_t i = 0; i < scene.parts.size(); ++i) {
    for (const std::uint32_t hull : scene.parts[i].hulls) {
      for (const Vec3d& vertex : scene.hulls[hull].vertices) {
        const Vec3d world = transformPoint(poses[i], vertex);
        for (const Plane& plane : frustum.planes) {
          if (plane.evaluate(world) < 0.0) {
            return scene.parts[i].name;
          }
        }
      }
    }
  }
  return "";
}

}  // namespace sightline::scene_checks
