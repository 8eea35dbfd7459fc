// Compiled with all warnings as errors, as a project of somebody else may be: settings are given as the
// examples give them, by the names of those members that differ from their defaults.

#include "sightline/culling/culler.h"
#include "sightline/culling/depth_pyramid_method.h"
#include "sightline/culling/detail_objects.h"
#include "sightline/culling/occlusion_tree_method.h"
#include "sightline/culling/opacity_map_method.h"
#include "sightline/hierarchy/hierarchy.h"
#include "sightline/layers/layer_sorter.h"
#include "sightline/layers/pre_split.h"
#include "sightline/occluders/choose_occluders.h"
#include "sightline/occluders/occluder_database.h"
#include "sightline/occluders/occluder_set.h"
#include "sightline/occlusion/depth_pyramid.h"
#include "sightline/occlusion/occlusion_tree.h"
#include "sightline/occlusion/opacity_map.h"
#include "sightline/pvs/query/set_query.h"
#include "sightline/scene/camera.h"
#include "sightline/scene/scene.h"

using namespace sightline;

int main() {
  const CullerSettings culler{.occluders = {.lambda_steps = 4.0}};
  const CullingScene culled{.occluders = nullptr};
  const DepthPyramidMethodSettings pyramid_method{.focus = {.magnification = 4.0}};
  const OcclusionTreeMethodSettings tree_method{.temporal_coherence = false};
  const OpacityMapMethodSettings opacity_method{.triangle_us = 1.0};
  const DetailObjectsSettings detail{.occluder_count = 4};
  const FocusSettings focus{.magnification = 2.0};
  const RasterSettings raster{.width = 64};
  const DepthPyramidSettings pyramid{.raster = {.width = 64}};
  const OpacityMapSettings opacity{.tolerance = 0};
  const OcclusionTreeSettings tree{.variant = OcclusionTreeVariant::kFSE};
  const SupportingPlanesSettings planes{.joint_occlusion = false};
  const HierarchySettings hierarchy{.kind = HierarchyKind::kKdTree};
  const OccluderSettings occluders{.max_vertices = 8};
  const ChoiceSettings choice{.count = 8};
  const OccluderDatabaseSettings database{.directions = 8};
  const SetQuerySettings query{.cache_bytes = 1024};
  const LayerSettings layers{.arcs = LayerArcs::kAll};
  const PartSettings part{.is_static = true};
  const ExtentAxis axis{.kind = ExtentAxis::Kind::kAngular};
  const PairPlane plane{.plane = {.offset = 1.0}};
  const SphereCylinderJoint joint{.sphere_radius = 2.0};
  const SplitAxis split{.count = 2};
  const CylinderOptions cylinder{.sectors = 6};
  const HexagonOptions hexagons{.width = 2.0};
  const View view{.z_near = 1.0};
  const CameraFrame frame{.forward = {0, 0, -1}};
  const CameraPath path{.z_near = 1.0};
  const Object object{.index_count = 3};
  const Material material{.double_sided = true};
  const SceneView scene{.indices = {}};
  const Plane face{.offset = 1.0};
  return culler.occluders.lambda_steps > 1.0 && culled.occluders == nullptr &&
                 pyramid_method.focus.magnification > 1.0 && !tree_method.temporal_coherence &&
                 opacity_method.triangle_us > 0.0 && detail.occluder_count == 4 &&
                 focus.magnification > 1.0 && raster.width == 64 && pyramid.raster.width == 64 &&
                 opacity.tolerance == 0 && tree.variant == OcclusionTreeVariant::kFSE &&
                 !planes.joint_occlusion && hierarchy.kind == HierarchyKind::kKdTree &&
                 occluders.max_vertices == 8 && choice.count == 8 && database.directions == 8 &&
                 query.cache_bytes == 1024 && layers.arcs == LayerArcs::kAll && part.is_static &&
                 axis.kind == ExtentAxis::Kind::kAngular && plane.plane.offset > 0.0 &&
                 joint.sphere_radius > 1.0 && split.count == 2 && cylinder.sectors == 6 &&
                 hexagons.width > 1.0 && view.z_near > 0.5 && frame.forward.z < 0.0 && path.z_near > 0.5 &&
                 object.index_count == 3 && material.double_sided && scene.objects.empty() &&
                 face.offset > 0.0
             ? 0
             : 1;
}
