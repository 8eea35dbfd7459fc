#pragma once

// Demo scenes prepared for culling, and views of them.

#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scenes/procedural.h"
#include "sightline/occluders/occluder_database.h"
#include "sightline/occluders/surface_set.h"
#include "tests/support/any_culler.h"
#include "tests/support/object_arrays.h"

namespace sightline::demo_frames {

constexpr HierarchyKind kKinds[] = {HierarchyKind::kKdTree, HierarchyKind::kBvh};

struct NamedSettings {
  const char* name;
  AnySettings settings;
  bool stands_for_method = false;  // one of each method is enough for slow tests
};

// Settings of every structure: the variants of the occlusion tree, the forms of the supporting planes, the
// opacity map and the depth pyramid.
constexpr NamedSettings kStructures[] = {
    {"FSE", {.variant = OcclusionTreeVariant::kFSE}},
    {"FSC", {.variant = OcclusionTreeVariant::kFSC}},
    {"FME", {.variant = OcclusionTreeVariant::kFME}, true},
    {"FMC", {.variant = OcclusionTreeVariant::kFMC}},
    {"planes through the eye", {.method = AnyMethod::kSupportingPlanes}, true},
    {"planes through the box", {.method = AnyMethod::kKeptPlanes}, true},
    {"planes through the eye, no joint occlusion",
     {.method = AnyMethod::kSupportingPlanes, .supporting_planes = {.joint_occlusion = false}}},
    {"planes through the box, no joint occlusion",
     {.method = AnyMethod::kKeptPlanes, .kept_planes = {.joint_occlusion = false}}},
    {"opacity map", {.method = AnyMethod::kOpacityMap, .raster = {.width = 64, .height = 36}}, true},
    {"depth pyramid", {.method = AnyMethod::kDepthPyramid}, true},
    {"depth pyramid, focused", {.method = AnyMethod::kDepthPyramid, .focus = {.worth = 1e9}}, true},
};
inline std::vector<NamedSettings> oneOfEachMethod() {
  std::vector<NamedSettings> chosen;
  for (const NamedSettings& structure : kStructures) {
    if (structure.stands_for_method) {
      chosen.push_back(structure);
    }
  }
  return chosen;
}
inline const std::vector<NamedSettings> kMethods = oneOfEachMethod();

// What many tests do not need: it is made when it is first asked for, by one thread at a time.
template <typename T>
class OnFirstUse {
 public:
  template <typename Make>
  const T& get(Make&& make) const {
    if (!value_) {
      value_.emplace(make());
    }
    return *value_;
  }

 private:
  mutable std::optional<T> value_;
};

struct DemoScene {
  Scene scene;
  std::vector<Box> bounds;
  Hierarchy kd_tree, bvh;
  OccluderSet occluders;

  explicit DemoScene(Scene source) : scene(std::move(source)) {
    test::ObjectArrays objects(scene);
    bounds = std::move(objects.boxes);
    kd_tree = buildHierarchy(bounds, objects.triangles, {.kind = HierarchyKind::kKdTree});
    bvh = buildHierarchy(bounds, objects.triangles, {.kind = HierarchyKind::kBvh});
    occluders = findOccluders(scene.view());
  }
  const OccluderDatabase& database() const {
    return database_.get([&] { return coarseDatabase(false); });
  }
  const OccluderDatabase& detailDatabase() const {
    return detail_database_.get([&] { return coarseDatabase(true); });
  }
  const SurfaceSet& surfaces() const {
    return surfaces_.get([&] { return findSurfaces(scene.view()); });
  }
  const ObjectBoxes& objectBoxes() const {
    return object_boxes_.get([&] { return findObjectBoxes(scene.view()); });
  }
  const Hierarchy& hierarchy(HierarchyKind kind) const {
    return kind == HierarchyKind::kKdTree ? kd_tree : bvh;
  }
  AnyCuller culler(HierarchyKind kind, const AnySettings& settings) const {
    return AnyCuller(hierarchy(kind), bounds, occluders, settings, listsFor(settings));
  }
  // What of the scene a culler with these settings uses.
  AnyLists listsFor(const AnySettings& settings) const {
    return {.from_eye = settings.use_lists ? &database() : nullptr,
            .from_objects = settings.detail_objects ? &detailDatabase() : nullptr,
            .surfaces = settings.surfaces != SurfaceUse::kNone ? &surfaces() : nullptr,
            .object_boxes = settings.object_boxes ? &objectBoxes() : nullptr};
  }
  // Returns the views of frames first, first + 1, ... of a camera path; fewer at its end.
  std::vector<View> frames(const CameraPath& path, std::size_t first, std::size_t count) const {
    std::vector<View> views;
    for (std::size_t f = first; f < path.frames.size() && f < first + count; ++f) {
      views.push_back(path.view(f, scene.origin));
    }
    return views;
  }

 private:
  OccluderDatabase coarseDatabase(bool turned_away) const {
    return OccluderDatabase::build(
        kd_tree, occluders,
        {.directions = 16, .occluder_count = 128, .max_bytes = 1u << 20, .turned_away = turned_away});
  }

  OnFirstUse<OccluderDatabase> database_, detail_database_;
  OnFirstUse<SurfaceSet> surfaces_;
  OnFirstUse<ObjectBoxes> object_boxes_;
};

inline const DemoScene& smallCity() {
  static const DemoScene kCity(makeCity({.copies = 2}));
  return kCity;
}
inline const DemoScene& smallBuilding() {
  static const DemoScene kBuilding(makeBuilding({.floors = 2, .plants = 10}));
  return kBuilding;
}

inline std::string nameOf(HierarchyKind kind) {
  return kind == HierarchyKind::kKdTree ? "kd-tree" : "bvh";
}

// Returns views of random places in and around the scene, in random directions and both projections. Each is
// a jump.
inline std::vector<View> jumps(const DemoScene& demo, std::uint64_t seed, std::size_t count) {
  std::mt19937_64 random(seed);
  const auto in = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
  };
  const Box all = sceneBounds(demo.scene.view());
  std::vector<View> views;
  for (std::size_t i = 0; i < count; ++i) {
    View view;
    for (int axis = 0; axis < 3; ++axis) {
      const double margin = 0.1 * (static_cast<double>(all.max[axis]) - all.min[axis]);
      view.eye[axis] = in(all.min[axis] - margin, all.max[axis] + margin);
    }
    setOrientation(view, {in(-1, 1), in(-1, 1), in(-0.4, 0.4)}, {0, 0, 1});
    view.orthographic = i % 2 == 1;
    view.ortho_height = in(5.0, 60.0);
    view.tan_half_fovy = in(0.2, 1.2);
    view.z_near = in(0.05, 1.0);
    view.z_far = in(50.0, 1000.0);
    views.push_back(view);
  }
  return views;
}

}  // namespace sightline::demo_frames
