#pragma once

// The occluder databases that a baked file can hold.

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "sightline/base/parallel_for.h"
#include "sightline/pvs/format/baked_visibility.h"
#include "sightline/scene/scene.h"

namespace sightline::tool {

// Their names in DatabaseBlob::name.
inline constexpr std::array<std::string_view, 5> kBakedDatabases{"area-angle", "detail", "minimum-sets",
                                                                 "first-hit", "projected-size"};
std::string listBakedDatabases();  // "a, b, c"

// Builds the databases of these names (of kBakedDatabases) with the library's settings, for the occluders
// that commands cull with.
std::vector<DatabaseBlob> buildDatabases(const Scene& scene, const std::vector<std::string>& names,
                                         const ParallelFor& parallel_for);

}  // namespace sightline::tool
