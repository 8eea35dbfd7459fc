#pragma once

// What is in a .sight file: for `info`, and for the report of `bake`.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/pvs/query/sight_file.h"
#include "tools/sightline/methods/method_options.h"

namespace sightline::tool {

// Mean, standard deviation and range of numbers.
struct Spread {
  std::uint64_t count = 0;
  double mean = 0.0, deviation = 0.0, min = 0.0, max = 0.0;
};
Spread spreadOf(const std::vector<double>& values);

inline constexpr std::size_t kShares = 10;  // bars of a histogram, a tenth of the scene's triangles each

// Of cells where viewers are. Cells without a plane count once, those with one twice: in front of it and
// behind it.
struct SetSizes {
  Spread objects, triangles;
  std::array<std::uint64_t, kShares> histogram{};  // by triangles
};

struct SightFacts {
  std::uint64_t cells = 0;
  std::uint32_t deepest = 0;               // level
  std::vector<std::uint64_t> level_cells;  // by level
  std::vector<SetSizes> level_sizes;       // by level
  SetSizes sizes;                          // of all levels
  double mean_triangles_by_volume = 0.0;   // of a viewer who is anywhere with equal chance
  std::array<std::uint64_t, kStopReasons> reasons{};
  std::array<double, kStopReasons> reason_volumes{};  // of the viewers' space, 0 to 1
  std::uint64_t cells_with_plane = 0;
  std::uint64_t grid_cells = 0;  // of a uniform grid with the smallest cell
};

// Reads all sets: an error where one is broken.
Result<SightFacts> factsOf(const SightFile& file);

Json factsJson(const SightFacts& facts);
Json sightJson(const SightFile& file, const SightFacts& facts);
std::string factsText(const SightFacts& facts);  // lines as `info` prints them

// Where the baked scene's origin lies in world space. Files that do not say have it at zero.
Vec3d originOf(const BakeRecord& record);

// What the record says about the convex occluders that were considered.
struct OccluderFacts {
  bool none = false;          // but for the floor, ceiling and outer walls of the viewers' region
  bool none_of_use = false;   // none of the others is large enough for the smallest cells
  double largest_area = 0.0;  // of the others, square metres
  double size = 1.0;          // BakeSettings::occluder_size
};
std::optional<OccluderFacts> occludersOf(const BakeRecord& record);

// Three finite numbers, or nothing.
std::optional<Vec3d> pointOf(const Json& json);

bool beginsAsSightFile(const std::string& name);  // by its first bytes
bool isSightFile(const std::string& name);        // by its name or its first bytes

// `info F.sight`.
Status informOnSight(const std::string& name, const std::string& json_target);

}  // namespace sightline::tool
