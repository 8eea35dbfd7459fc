#pragma once

// The occluder databases that a baked file can hold.

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "sightline/base/parallel_for.h"
#include "sightline/comparison/viewpoint_database.h"
#include "sightline/pvs/format/baked_visibility.h"
#include "sightline/scene/scene.h"

namespace sightline::tool {

// Their names in DatabaseBlob::name.
inline constexpr std::array<std::string_view, 5> kBakedDatabases{"area-angle", "detail", "minimum-sets",
                                                                 "first-hit", "projected-size"};
std::string listBakedDatabases();  // "a, b, c"

// Which databases are stored, and how those at grid points are made.
struct DatabaseChoice {
  std::vector<std::string> names{};  // of kBakedDatabases
  ViewpointDatabaseSettings viewpoints{};
  std::vector<Vec3d> places{};  // scene space: grid points lie near these; none: in the scene's box
};

// Builds the databases for the occluders that commands cull with.
std::vector<DatabaseBlob> buildDatabases(const Scene& scene, const DatabaseChoice& choice,
                                         const ParallelFor& parallel_for);

}  // namespace sightline::tool
