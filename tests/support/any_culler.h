#pragma once

// Cullers with any method, from one struct of settings: for tests and benchmarks that run over all methods.
// A method that is added gets a value of AnyMethod, a member of AnySettings if it has settings, and a case in
// makeMethod().

#include <cstdint>
#include <memory>
#include <span>

#include "sightline/comparison/kept_planes_method.h"
#include "sightline/culling/culler.h"
#include "sightline/culling/depth_pyramid_method.h"
#include "sightline/culling/detail_objects.h"
#include "sightline/culling/frustum_method.h"
#include "sightline/culling/occlusion_tree_method.h"
#include "sightline/culling/opacity_map_method.h"
#include "sightline/culling/supporting_planes_method.h"
#include "sightline/culling/visibility_octree_method.h"

namespace sightline {

enum class AnyMethod : std::uint8_t {
  kFrustum,
  kOcclusionTree,
  kSupportingPlanes,
  kKeptPlanes,
  kOpacityMap,
  kDepthPyramid,
  kVisibilityOctree,
};

struct AnySettings {
  AnyMethod method = AnyMethod::kOcclusionTree;
  OcclusionTreeVariant variant = OcclusionTreeVariant::kFME;
  SupportingPlanesSettings supporting_planes{};
  KeptPlanesSettings kept_planes{};
  RasterSettings raster{};
  FocusSettings focus{};
  SurfaceUse surfaces = SurfaceUse::kNone;
  SurfaceLimits drawing{};
  bool temporal_coherence = true;
  std::uint32_t occluder_count = 64;
  AreaAngleDirection area_angle_direction = AreaAngleDirection::kOccluder;
  double lambda_steps = 0.0;
  std::uint32_t min_node_cost = 0;
  bool visible_sets = false;
  std::uint32_t views_at_once = 1;
  bool test_objects = true;
  bool use_lists = false;  // occluders come from AnyLists::from_eye
  bool detail_objects = false;
  std::uint32_t detail_occluder_count = 8;
  bool object_boxes = false;  // objects are tested by AnyLists::object_boxes too
};

inline std::unique_ptr<CullingMethod> makeMethod(const AnySettings& settings) {
  KeptPlanesSettings kept = settings.kept_planes;
  kept.keep_relations = settings.temporal_coherence;
  switch (settings.method) {
    case AnyMethod::kFrustum:
      return frustumCulling();
    case AnyMethod::kOcclusionTree:
      return occlusionTree({settings.variant, settings.temporal_coherence});
    case AnyMethod::kSupportingPlanes:
      return supportingPlanes(settings.supporting_planes);
    case AnyMethod::kKeptPlanes:
      return keptPlanes(kept);
    case AnyMethod::kOpacityMap:
      return opacityMap(
          {.map = {.raster = settings.raster}, .surfaces = settings.surfaces, .drawing = settings.drawing});
    case AnyMethod::kDepthPyramid:
      return depthPyramid({.raster = settings.raster,
                           .focus = settings.focus,
                           .temporal_coherence = settings.temporal_coherence,
                           .surfaces = settings.surfaces,
                           .drawing = settings.drawing});
    case AnyMethod::kVisibilityOctree:
      return visibilityOctree();
  }
  return nullptr;
}

// What some settings use of a scene, made ahead.
struct AnyLists {
  const OccluderLists* from_eye = nullptr;      // with AnySettings::use_lists
  const OccluderLists* from_objects = nullptr;  // with AnySettings::detail_objects
  const SurfaceSet* surfaces = nullptr;         // with AnySettings::surfaces
  const ObjectBoxes* object_boxes = nullptr;    // with AnySettings::object_boxes
};

class AnyCuller : public Culler {
 public:
  AnyCuller(const Hierarchy& hierarchy, std::span<const Box> object_bounds, const OccluderSet& occluders,
            const AnySettings& settings = {}, const AnyLists& lists = {}, VisibleSets* sets = nullptr)
      : Culler(sceneOf(hierarchy, object_bounds, occluders, settings, lists, sets),
               withDetail(makeMethod(settings), settings),
               {.occluders = {.count = settings.occluder_count,
                              .area_angle_direction = settings.area_angle_direction,
                              .lambda_steps = settings.lambda_steps},
                .min_node_cost = settings.min_node_cost,
                .test_objects = settings.test_objects,
                .visible_sets = settings.visible_sets,
                .views_at_once = settings.views_at_once}),
        settings_(settings) {}

  using Culler::reset;
  void reset(const Hierarchy& hierarchy, std::span<const Box> object_bounds, const OccluderSet& occluders,
             const AnyLists& lists = {}, VisibleSets* sets = nullptr) {
    Culler::reset(sceneOf(hierarchy, object_bounds, occluders, settings_, lists, sets));
  }

 private:
  static CullingScene sceneOf(const Hierarchy& hierarchy, std::span<const Box> object_bounds,
                              const OccluderSet& occluders, const AnySettings& settings,
                              const AnyLists& lists, VisibleSets* sets) {
    return {.hierarchy = &hierarchy,
            .object_bounds = object_bounds,
            .object_boxes = settings.object_boxes ? lists.object_boxes : nullptr,
            .occluders = &occluders,
            .surfaces = lists.surfaces,
            .occluder_lists = settings.use_lists ? lists.from_eye : nullptr,
            .near_objects = lists.from_objects,
            .sets = sets};
  }
  static std::unique_ptr<CullingMethod> withDetail(std::unique_ptr<CullingMethod> method,
                                                   const AnySettings& settings) {
    return settings.detail_objects && method->traits().occluders
               ? detailObjects(std::move(method), {.occluder_count = settings.detail_occluder_count})
               : std::move(method);
  }

  AnySettings settings_;
};

}  // namespace sightline
