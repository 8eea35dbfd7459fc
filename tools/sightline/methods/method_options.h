#pragma once

// The command line's options of culling methods, and the library settings that they stand for.

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "sightline/base/result.h"
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

namespace CLI {
class App;
}

namespace sightline::tool {

using Json = nlohmann::ordered_json;

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
  SurfaceDrawing surface_drawing{};
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

// The options as text, one element per option; several values are separated by commas.
struct MethodOptions {
  MethodOptions();  // the library's defaults

  // Changes the default of an option; name: without "--". Precondition: there is such an option.
  void setDefault(std::string_view name, const std::string& text);

  std::vector<std::string> texts;
  std::vector<std::string> defaults;  // texts that the user has not given
  std::vector<bool> given;            // whether the user has, be it the default
  std::string baked;                  // a .sight file; empty: none
  std::string closed;                 // closed doors of the baked file (closedDoors); empty: none
  std::string prepared;               // a PreparedFile; empty: none
  double crack_width = 0.0;           // metres
  std::uint32_t clusters = 0;         // triangles of a cluster (addClustersOption); 0: objects stay whole
};
void addMethodOptions(CLI::App& command, MethodOptions& options, bool lists);

// Returns all combinations of the options' values, in the order of the lists. A method is combined only with
// the options that it has. Names on stderr the given options that no method has. Returns an error if a
// combination needs a baked file and there is none. --method auto stands for what was chosen; what the user
// gave wins over it. Before there is a choice, null only checks the options: auto stands for some method.
Result<std::vector<Setting>> settingsOf(const MethodOptions& options,
                                        const std::shared_ptr<const MethodChoice>& choice = nullptr);
// Whether --method auto is among the methods.
bool asksForChoice(const MethodOptions& options);

// The criterion of a choice that uses the viewpoint database.
OccluderCriterion criterionOf(OccluderChoice choice);

std::string methodName(const Setting& setting);
// Returns a text for people: "FME, 64 occluders, bvh, coherence on", followed by what differs from the
// defaults.
std::string optionsText(const Setting& setting);
Json optionsJson(const Setting& setting);

}  // namespace sightline::tool
