#include "tools/sightline/methods/method.h"

#include <algorithm>

#include "sightline/comparison/kept_planes_method.h"
#include "sightline/culling/depth_pyramid_method.h"
#include "sightline/culling/frustum_method.h"
#include "sightline/culling/occlusion_tree_method.h"
#include "sightline/culling/opacity_map_method.h"
#include "sightline/culling/supporting_planes_method.h"
#include "sightline/culling/visibility_octree_method.h"
#include "tools/sightline/methods/setting.h"

namespace sightline::tool {
namespace {

std::unique_ptr<CullingMethod> makePlanes(const Setting& s) {
  if (s.plane_form == PlaneForm::kThroughEye) {
    return supportingPlanes({.joint_occlusion = s.kept_planes.joint_occlusion});
  }
  KeptPlanesSettings settings = s.kept_planes;
  settings.keep_relations = s.temporal_coherence;
  return keptPlanes(settings);
}

const std::vector<Method>& methods() {
  static const std::vector<Method> kMethods{
      {"frustum", kFrustumTraits, [](const Setting&) { return frustumCulling(); }, {}},
      {"supporting-planes",
       kSupportingPlanesTraits,
       makePlanes,
       {"planes", "coherence", "joint", "relation-mib", "tangents"}},
      {"occlusion-tree",
       kOcclusionTreeTraits,
       [](const Setting& s) {
         return occlusionTree({.variant = s.variant, .temporal_coherence = s.temporal_coherence});
       },
       {"variant", "coherence"},
       /*hidden_statistics=*/{"tree"}},
      {"opacity-map",
       kOpacityMapTraits,
       [](const Setting& s) {
         OpacityMapMethodSettings settings = s.opacity_map;
         settings.map.raster = s.raster;
         settings.surfaces = s.surfaces();
         settings.drawing = s.surface_drawing;
         settings.budget_us = s.budget_us;
         return opacityMap(settings);
       },
       {"resolution", "coverage", "surfaces", "surface-pixels", "surface-budget", "budget-us", "tolerance",
        "coverage-ratio", "depth-comparison", "triangle-us"},
       /*hidden_statistics=*/{"coverage"}},
      {"depth-pyramid",
       kDepthPyramidTraits,
       [](const Setting& s) {
         return depthPyramid({.raster = s.raster,
                              .focus = s.focus,
                              .temporal_coherence = s.temporal_coherence,
                              .surfaces = s.surfaces(),
                              .drawing = s.surface_drawing,
                              .budget_us = s.budget_us});
       },
       {"resolution", "coverage", "surfaces", "surface-pixels", "surface-budget", "budget-us", "coherence",
        "views-at-once", "focus", "focus-resolution", "focus-occluder-count", "focus-windows",
        "focus-worth"}},
      {"visibility-octree", kVisibilityOctreeTraits, [](const Setting&) { return visibilityOctree(); }, {}},
  };
  return kMethods;
}

}  // namespace

std::span<const Method> allMethods() {
  return methods();
}

const Method& methodNamed(std::string_view name) {
  const std::span<const Method> all = allMethods();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Method& method) { return method.name == name; });
  return found != all.end() ? *found : all.front();
}

}  // namespace sightline::tool
