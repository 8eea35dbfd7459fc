#pragma once

// Says when baked sets hide next to nothing, and why.

#include <string>

#include "sightline/pvs/query/sight_file.h"
#include "tools/sightline/cull/info_sight.h"

namespace sightline::tool {

// One line for whoever baked the file, without its name; empty where the sets are of use.
std::string bakeWarning(const SightFile& file, const SightFacts& facts);

}  // namespace sightline::tool
