#pragma once

// Warns if baked sets hide next to nothing, and says why; and if those of single occluders hide little.

#include <string>

#include "sightline/pvs/query/sight_file.h"
#include "tools/sightline/cull/info_sight.h"

namespace sightline::tool {

// One line for the user, without the file's name; empty if the sets hide enough.
std::string bakeWarning(const SightFile& file, const SightFacts& facts);

}  // namespace sightline::tool
