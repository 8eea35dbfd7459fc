#pragma once

// A culling method with all its settings, and the library's objects that are made of it.

#include <cstdint>
#include <memory>
#include <string>

#include "sightline/comparison/kept_planes.h"
#include "sightline/comparison/viewpoint_database.h"
#include "sightline/culling/culler.h"
#include "sightline/culling/depth_pyramid_method.h"
#include "sightline/culling/detail_objects.h"
#include "sightline/culling/occlusion_tree_method.h"
#include "sightline/culling/opacity_map_method.h"
#include "sightline/culling/while_it_pays.h"
#include "sightline/hierarchy/hierarchy.h"
#include "sightline/occluders/occluder_database.h"
#include "tools/sightline/methods/method.h"
#include "tools/sightline/methods/method_names.h"

namespace sightline::tool {

struct MethodChoice;

// One method with one value of each option: the settings of every method, of which its own counts.
struct Setting {
  HierarchyKind hierarchy = HierarchySettings{}.kind;
  const Method* method = &methodNamed("depth-pyramid");
  CullerSettings culler{};
  OccluderChoice occluders = OccluderChoice::kAreaAngle;
  OccluderDatabaseSettings database{};
  ViewpointDatabaseSettings viewpoints{};
  bool detail_objects = false;
  DetailObjectsSettings detail{};
  RendererCost renderer{};
  SurfaceOption surface_option = SurfaceOption::kAutomatic;
  SurfaceLimits surface_drawing{};
  double budget_us = 0.0;               // of a frame with surfaces
  std::uint32_t object_box_option = 0;  // 0: see objectBoxes()
  bool temporal_coherence = true;       // for the methods that have it
  OcclusionTreeVariant variant = OcclusionTreeMethodSettings{}.variant;
  PlaneForm plane_form = PlaneForm::kThroughEye;
  KeptPlanesSettings kept_planes{};
  RasterSettings raster{};  // for the opacity map and the depth pyramid
  OpacityMapMethodSettings opacity_map{};
  FocusSettings focus{};
  bool baked = false;                            // there is a baked file
  std::shared_ptr<const MethodChoice> choice{};  // by which --method auto became this; null: the user's own

  SurfaceUse surfaces() const;
  // The most boxes of an object; if none were asked for, those of the depth pyramid, and one of other
  // methods.
  std::uint32_t objectBoxes() const;
  bool usesOccluders() const;  // the method can choose occluders
  bool choosesOccluders() const;
  bool usesDatabase() const;
  bool usesViewpoints() const;
  bool usesDepthBuffer() const;
  bool approximate() const;  // may cull visible objects
  bool testsDetailObjects() const;
  bool knowsRendererCost() const;
  bool usesVisibleSets() const;
};

// Makes the method of the setting, with the second test of detail objects if the setting has it, and for as
// long as it pays if the renderer's cost is known.
std::unique_ptr<CullingMethod> makeMethod(const Setting& setting);

// The criterion of a choice that uses the viewpoint database.
OccluderCriterion criterionOf(OccluderChoice choice);

std::string methodName(const Setting& setting);

}  // namespace sightline::tool
