#include "scenes/moving_scene.h"

#include <unordered_map>

namespace sightline {
namespace {

Vec3d column(const Mat4& m, int i) {
  return {m(0, i), m(1, i), m(2, i)};
}

// The inverse of a rigid matrix: the transposed rotation, and the translation rotated back and negated.
Mat4 inverseRigid(const Mat4& m) {
  Mat4 inverse;
  for (int row = 0; row < 3; ++row) {
    for (int i = 0; i < 3; ++i) {
      inverse(row, i) = m(i, row);
    }
    inverse(row, 3) = -dot(column(m, row), column(m, 3));
  }
  return inverse;
}

// The same motion for points whose coordinates are relative to `origin`.
Mat4 aboutOrigin(const Mat4& motion, const Vec3d& origin) {
  Mat4 moved = motion;
  const Vec3d offset = transformPoint(motion, origin) - origin;
  for (int row = 0; row < 3; ++row) {
    moved(row, 3) = offset[row];
  }
  return moved;
}

}  // namespace

LayerSorter makeSorter(const MovingScene& scene, const LayerSettings& settings) {
  LayerSorter sorter(settings);
  for (const ConvexHull& hull : scene.hulls) {
    sorter.addHull(hull);
  }
  for (const MovingPart& part : scene.parts) {
    const std::vector<HullId> hulls(part.hulls.begin(), part.hulls.end());
    sorter.addPart(hulls, part.settings);
  }
  for (const MovingPlane& plane : scene.planes) {
    sorter.setRule(PartId(plane.first), PartId(plane.second), plane.rule);
  }
  for (const MovingJoint& joint : scene.joints) {
    sorter.setRule(PartId(joint.first), PartId(joint.second), joint.rule);
  }
  return sorter;
}

void pose(const MovingScene& scene, std::uint32_t frame, std::vector<Mat4>& poses, LayerSorter& sorter) {
  if (!scene.pose) {
    return;
  }
  poses.resize(scene.parts.size());
  scene.pose(frame, poses);
  for (std::uint32_t part = 0; part < poses.size(); ++part) {
    sorter.setTransform(PartId(part), poses[part]);
  }
}

void scenePoses(const MovingScene& scene, std::uint32_t frame, std::vector<Mat4>& scene_from_part) {
  scene_from_part.assign(scene.pose ? scene.parts.size() : 0, Mat4{});
  if (!scene.pose) {
    return;
  }
  scene.pose(frame, scene_from_part);
  for (Mat4& pose : scene_from_part) {
    for (int row = 0; row < 3; ++row) {
      pose(row, 3) -= scene.scene.origin[row];
    }
  }
}

void placements(const MovingScene& scene, std::uint32_t frame, std::vector<Mat4>& scene_from_stored) {
  scene_from_stored.assign(scene.scene.objects.size(), Mat4{});
  if (!scene.pose) {
    return;
  }
  std::vector<Mat4> first(scene.parts.size()), now(scene.parts.size());
  scene.pose(0, first);
  scene.pose(frame, now);
  for (std::size_t i = 0; i < scene_from_stored.size(); ++i) {
    // Parts that have not moved keep the exact identity.
    if (now[i].m != first[i].m) {
      scene_from_stored[i] = aboutOrigin(now[i] * inverseRigid(first[i]), scene.scene.origin);
    }
  }
}

void posedScene(const MovingScene& scene, std::uint32_t frame, Scene& posed) {
  std::vector<Mat4> scene_from_stored;
  placements(scene, frame, scene_from_stored);
  posed = scene.scene;
  posed.positions.clear();
  posed.indices.clear();
  std::unordered_map<std::uint32_t, std::uint32_t> number_of;  // of one object's positions, by stored index
  const SceneView stored = scene.scene.view();
  for (std::size_t i = 0; i < posed.objects.size(); ++i) {
    Object& object = posed.objects[i];
    object.first_index = static_cast<std::uint32_t>(posed.indices.size());
    object.bounds = {};
    number_of.clear();
    for (const std::uint32_t index : stored.indicesOf(stored.objects[i])) {
      const auto next = static_cast<std::uint32_t>(posed.positions.size());
      const auto [found, is_new] = number_of.try_emplace(index, next);
      if (is_new) {
        posed.positions.emplace_back(transformPoint(scene_from_stored[i], Vec3d(stored.positions[index])));
        object.bounds.extend(posed.positions.back());
      }
      posed.indices.push_back(found->second);
    }
  }
}

}  // namespace sightline
