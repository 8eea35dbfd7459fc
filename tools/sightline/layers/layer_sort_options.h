#pragma once

// The options of `layers` that say how parts are sorted.

#include <string>

#include "sightline/layers/compositing.h"
#include "tools/sightline/command_line/json_output.h"
#include "tools/sightline/command_line/options.h"

namespace sightline::tool {

struct LayerSortOptions {
  std::string sort = "depth-first", search = "scan", extents = "camera", arcs = "groups",
              expression = "cheapest", conditioning = "on", exact = "on", frustum_culling = "off";
  double contact_tolerance = 1e-6;
};
void addLayerSortOptions(CLI::App& command, LayerSortOptions& options);

// all_arcs: whatever --arcs says.
LayerSettings settingsOf(const LayerSortOptions& options, bool all_arcs);
// Whether the order is that of what the pixels of a picture show (layer_seen_arcs.h).
bool sortsBySeen(const LayerSortOptions& options);
CompositingForm formOf(const LayerSortOptions& options);
Json optionsJson(const LayerSortOptions& options);

}  // namespace sightline::tool
