#pragma once

// The tables of `reproduce poon-wang`, the published figures in them, and what they say.

#include <string>
#include <vector>

#include "tools/sightline/reproduce/reproduction.h"

namespace sightline::tool::poon_wang {

// Cullings as the tables name them.
inline constexpr const char *kFrustum = "VF", *kOpacityMap = "OM", *kPixelwise = "PC",
                            *kPeaksAlways = "OM, peaks always";

// Without rows. picture: the size of the pictures, for titles.
struct Tables {
  Experiment occluder_counts, routes, depth_comparison, criteria, picture_sizes;
};
Tables emptyTables(const std::string& picture);

// Adds the paper's figures to the rows that it has figures for. Picture sizes are in the paper's order.
void addPublished(Tables& tables);

std::vector<Finding> findingsOf(const Tables& tables);

}  // namespace sightline::tool::poon_wang
