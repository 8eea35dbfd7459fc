#include "tools/sightline/layers/layer_sort_options.h"

#include <CLI/CLI.hpp>

#include <array>

#include "sightline/comparison/layer_sorting.h"
#include "tools/sightline/command_line/names.h"

namespace sightline::tool {
namespace {

// What --sort and --search choose.
constexpr std::array<Name<MakeLayerSort (*)()>, 2> kSorts{{
    {"depth-first", [] { return MakeLayerSort(); }},
    {"incremental", incrementalSort},
}};
constexpr std::array<Name<MakeCandidateSearch (*)()>, 2> kSearches{{
    {"scan", [] { return MakeCandidateSearch(); }},
    {"tree", [] { return extentTree(); }},
}};

// What --arcs reports. What is seen is found among all arcs of hulls.
constexpr std::array<Name<LayerArcs>, 3> kArcs{{
    {"groups", LayerArcs::kWithinGroups},
    {"all", LayerArcs::kAll},
    {"seen", LayerArcs::kAll},
}};

void addWordOption(CLI::App& command, const char* name, std::string& value,
                   const std::vector<std::string>& values, const char* help) {
  command.add_option(name, value, help)->check(isOneOf(values))->capture_default_str();
}

}  // namespace

void addLayerSortOptions(CLI::App& command, LayerSortOptions& options) {
  addWordOption(
      command, "--sort", options.sort, textsOf(kSorts),
      "depth-first search for strongly connected components, or the paper's reinsertion (incremental)");
  addWordOption(command, "--search", options.search, textsOf(kSearches), "how candidates are found");
  addWordOption(command, "--extents", options.extents, {"camera", "world"},
                "two angles and depth of the camera, or x, y, z of the world");
  addWordOption(
      command, "--arcs", options.arcs, textsOf(kArcs),
      "who occludes whom: within groups, or of all pairs, by hulls, of which no arc is missing; seen: "
      "from what is seen to what lies behind it there, so that groups are small: in pictures by their "
      "pixels, and approximate at a pixel, in drawings by outlines");
  addWordOption(command, "--expression", options.expression, textsOf(kCompositingForms),
                "how cycles without mutual occlusion are composited");
  addWordOption(command, "--conditioning", options.conditioning, textsOf(kSwitch),
                "let near groups move forward in the order (camera extents only)");
  addWordOption(command, "--exact", options.exact, textsOf(kSwitch),
                "off: extents alone decide, groups grow");
  addWordOption(command, "--frustum-culling", options.frustum_culling, textsOf(kSwitch),
                "on: parts outside the view are left out of the order");
  addDecimalOption(
      command, "--contact-tolerance", options.contact_tolerance, 0.0, 1000.0,
      "parts that touch, or overlap by less than a quarter of this, have an order, metres; 0: they "
      "are drawn together");
}

LayerSettings settingsOf(const LayerSortOptions& options, bool all_arcs) {
  LayerSettings settings;
  settings.sort = valueOf(kSorts, options.sort)();
  settings.search = valueOf(kSearches, options.search)();
  settings.extents = options.extents == "world" ? worldExtents() : cameraExtents();
  settings.exact = valueOf(kSwitch, options.exact);
  settings.frustum_culling = valueOf(kSwitch, options.frustum_culling);
  settings.contact_tolerance = options.contact_tolerance;
  settings.arcs = all_arcs ? LayerArcs::kAll : valueOf(kArcs, options.arcs);
  settings.conditioning = valueOf(kSwitch, options.conditioning);
  return settings;
}

bool sortsBySeen(const LayerSortOptions& options) {
  return options.arcs == "seen";
}

CompositingForm formOf(const LayerSortOptions& options) {
  return valueOf(kCompositingForms, options.expression);
}

Json optionsJson(const LayerSortOptions& options) {
  return {{"sort", options.sort},
          {"search", options.search},
          {"extents", options.extents},
          {"arcs", options.arcs},
          {"expression", options.expression},
          {"conditioning", options.conditioning},
          {"exact", options.exact},
          {"frustum_culling", options.frustum_culling},
          {"contact_tolerance", options.contact_tolerance}};
}

}  // namespace sightline::tool
