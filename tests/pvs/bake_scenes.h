#pragma once

// Small scenes for the baker, and an exact check of the baked sets.

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "oracle/exact_visibility.h"
#include "sightline/pvs/bake/bake.h"
#include "tests/support/solids.h"

namespace sightline::test {

// A scene with one object per solid.
inline Scene sceneOf(const std::vector<Solid>& solids) {
  Scene scene;
  scene.materials.emplace_back();
  for (const Solid& solid : solids) {
    Object object;
    object.first_index = static_cast<std::uint32_t>(scene.indices.size());
    object.material = MaterialId(0u);
    const auto first = static_cast<std::uint32_t>(scene.positions.size());
    scene.positions.insert(scene.positions.end(), solid.points.begin(), solid.points.end());
    for (const std::vector<std::uint32_t>& face : solid.faces) {
      for (std::size_t i = 1; i + 1 < face.size(); ++i) {
        for (const std::uint32_t corner : {face[0], face[i], face[i + 1]}) {
          scene.indices.push_back(first + corner);
        }
      }
    }
    object.index_count = static_cast<std::uint32_t>(scene.indices.size()) - object.first_index;
    scene.objects.push_back(object);
    scene.object_names.emplace_back("solid");
  }
  weldPositions(scene);
  updateBounds(scene);
  return scene;
}

inline OccluderSet allOccluders(const Scene& scene) {
  return findOccluders(scene.view(), {.area_fraction = 1.0});
}

inline BakedVisibility baked(const Scene& scene, const BakeSettings& settings) {
  const OccluderSet occluders = allOccluders(scene);
  Result<BakedVisibility> result = bakeVisibility(scene.view(), occluders, settings);
  EXPECT_TRUE(result) << (result ? "" : result.error().message);
  return result ? std::move(*result) : BakedVisibility{};
}

// A scene that is baked once, for files of any size. The scene must outlive it.
class BakedOnce {
 public:
  BakedOnce(const Scene& scene, const BakeSettings& settings)
      : scene_(scene), settings_(settings), occluders_(allOccluders(scene)) {
    const Result<Bake> bake = Bake::plan(scene_.view(), occluders_, settings_);
    EXPECT_TRUE(bake) << (bake ? "" : bake.error().message);
    parts_ = bake ? bake->bakeAll() : BakedParts{};
  }

  // The result, of at most so many bytes; 0: of any number.
  Result<BakedVisibility> fitted(std::uint64_t bytes) const {
    BakeSettings settings = settings_;
    settings.byte_budget = bytes;
    return Bake::plan(scene_.view(), occluders_, settings)->assemble(parts_);
  }

 private:
  const Scene& scene_;
  BakeSettings settings_;
  OccluderSet occluders_;
  BakedParts parts_;
};

// All parts, depth first: the last known part is baked first.
template <typename BakePart>
BakedParts partsOf(const Bake& bake, BakePart&& bake_part) {
  BakedParts parts;
  for (std::vector<PartTask> open{bake.firstPart()}; !open.empty();) {
    const PartTask part = open.back();
    open.pop_back();
    const BakedPart& bytes = parts.emplace(part.id, bake_part(part)).first->second;
    const std::vector<PartTask> below = bake.partsBelow(bytes);
    open.insert(open.end(), below.begin(), below.end());
  }
  return parts;
}

// A random point of a box.
inline Vec3d pointIn(const Vec3d& min, const Vec3d& max, std::mt19937& random) {
  Vec3d point;
  for (int axis = 0; axis < 3; ++axis) {
    point[axis] =
        min[axis] + (max[axis] - min[axis]) * std::uniform_real_distribution<double>(0.0, 1.0)(random);
  }
  return point;
}

// Indexed by ObjectId.
inline std::vector<bool> membersOf(const BakedVisibility& baked, std::uint32_t set) {
  std::vector<bool> members(baked.boxes.objects.size(), false);
  for (const std::uint32_t node : baked.sets[set]) {
    for (const ObjectId object : baked.boxes.view().objectsBelow(node)) {
      members[object.value] = true;
    }
  }
  return members;
}

// The set for viewers at this point, which must be in the leaf's cell.
inline std::uint32_t setAt(const OctreeView& octree, std::uint32_t leaf, const Vec3d& eye) {
  const OctreeLeaf& l = octree.leaves[leaf];
  if (l.plane == OctreeLeaf::kNoPlane) {
    return l.set;
  }
  const CellPlane& plane = octree.planes[l.plane];
  const double at = dot(plane.normal, eye);
  return at >= plane.front ? l.front_set : at <= plane.back ? l.back_set : l.set;
}

// Places viewers in every step-th cell, where it expects some: anywhere, and at faces, edges and corners.
// Every object that a ray reaches must be in their sets. near: near distance of the views, metres along their
// viewing direction.
class BakeJudge {
 public:
  BakeJudge(const Scene& scene, const BakedVisibility& baked) : exact_(scene.view()), baked_(baked) {}

  void judge(std::uint32_t views, std::uint32_t step, double near, std::uint32_t seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const OctreeView octree = baked_.octree.view();
    std::uint32_t count = 0;
    forEachLeaf(octree, [&](std::uint32_t leaf, const OctreeCell& cell) {
      const auto reason = static_cast<StopReason>(octree.reasons[leaf]);
      if (count++ % step != 0 || reason == StopReason::kOutside) {
        return;
      }
      for (std::uint32_t i = 0; i < views; ++i) {
        judgeView(leaf, placeIn(cell, octree.viewersOf(leaf), random), near, random);
      }
    });
  }

  std::size_t seen = 0,
              hidden = 0;  // objects that rays reached; pairs of a view and an object that is not in its set

 private:
  // Puts one coordinate in four on a border of the box of viewers.
  Vec3d placeIn(const OctreeCell& cell, const ViewerBounds& viewers, std::mt19937& random) const {
    const Vec3d low = viewersMin(baked_.octree.min, baked_.octree.max, cell, viewers);
    const Vec3d high = viewersMax(baked_.octree.min, baked_.octree.max, cell, viewers);
    Vec3d place;
    for (int axis = 0; axis < 3; ++axis) {
      const double t = std::uniform_real_distribution<double>(0.0, 1.0)(random);
      const std::uint32_t border = random() % 8;
      place[axis] = border == 0   ? low[axis]
                    : border == 1 ? high[axis]
                                  : low[axis] + (high[axis] - low[axis]) * t;
    }
    return place;
  }

  void judgeView(std::uint32_t leaf, const Vec3d& eye, double near, std::mt19937& random) {
    View view;
    view.eye = eye;
    const auto part = [&] { return std::normal_distribution<double>()(random); };
    setOrientation(view, {part(), part(), part()}, {0, 1, 0});
    view.tan_half_fovy = 1.0;
    view.aspect = 1.0;
    view.z_near = near / std::sqrt(3.0);
    view.z_far = 1e4;
    const std::vector<bool> members = membersOf(baked_, setAt(baked_.octree.view(), leaf, eye));
    std::vector<ObjectId> missing;
    for (std::size_t i = 0; i < members.size(); ++i) {
      if (!members[i]) {
        missing.push_back(ObjectId(i));
      }
    }
    hidden += missing.size();
    std::vector<SeenPoint> witnesses = exact_.visibleThroughPixels(view, 48, 48);
    seen += witnesses.size();
    const std::vector<SeenPoint> aimed = exact_.visibleByAimedRays(view, missing, 6);
    witnesses.insert(witnesses.end(), aimed.begin(), aimed.end());
    for (const SeenPoint& witness : witnesses) {
      if (!members[witness.object.value] && exact_.confirm(view, witness)) {
        ADD_FAILURE() << "object " << witness.object.value << " is seen at " << witness.point.x << " "
                      << witness.point.y << " " << witness.point.z << " from " << eye.x << " " << eye.y << " "
                      << eye.z << " in leaf " << leaf << ", but is not in its set";
      }
    }
  }

  ExactVisibility exact_;
  const BakedVisibility& baked_;
};

}  // namespace sightline::test
