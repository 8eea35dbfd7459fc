#pragma once

// Facts about a .sight file, for `info` and for the report of `bake`.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/pvs/query/sight_file.h"
#include "tools/sightline/command_line/json_output.h"

namespace sightline::tool {

// Mean, standard deviation and range of numbers.
struct Spread {
  std::uint64_t count = 0;
  double mean = 0.0, deviation = 0.0, min = 0.0, max = 0.0;
};
Spread spreadOf(const std::vector<double>& values);

inline constexpr std::size_t kShares = 10;  // bars of a histogram, each a tenth of the scene's triangles

// The sizes of the sets of cells where viewers are. A cell without a plane counts once, one with a plane
// twice: in front of the plane and behind it.
struct SetSizes {
  Spread objects, triangles;
  std::array<std::uint64_t, kShares> histogram{};  // by triangles
};

struct SightFacts {
  std::uint64_t cells = 0;
  std::uint32_t deepest = 0;               // the deepest level
  std::vector<std::uint64_t> level_cells;  // by level
  std::vector<SetSizes> level_sizes;       // by level
  SetSizes sizes;                          // of all levels
  double mean_triangles_by_volume = 0.0;   // for a viewer whose place is uniformly distributed
  std::array<std::uint64_t, kStopReasons> reasons{};
  std::array<double, kStopReasons> reason_volumes{};  // shares of the viewers' space, 0 to 1
  std::uint64_t cells_with_plane = 0;
  std::uint64_t partial_cells = 0;  // that expect viewers in a part of them
  std::uint64_t grid_cells = 0;     // cells of a uniform grid of the smallest cell's size
};

// Reads all sets. Error if one is broken. The sizes of sets are those while these doors are closed,
// ascending.
Result<SightFacts> factsOf(const SightFile& file, std::span<const ObjectId> closed = {});

Json factsJson(const SightFacts& facts);
Json sightJson(const SightFile& file, const SightFacts& facts);
std::string factsText(const SightFacts& facts);  // the lines that `info` prints
// A line that names the width of the cracks that were closed; empty if none were.
std::string cracksText(const SightFile& file);
// Lines that name the doors of the file; empty if it has none.
std::string doorsText(const SightFile& file);
// {"objects":n,"triangles":t}, and what addCracks() adds
Json bakedSceneJson(const SightFile& file);

// The baked scene's origin in world space; zero if the file does not tell.
Vec3d originOf(const BakeRecord& record);

// Facts about the convex occluders that the bake considered, from the record.
struct OccluderFacts {
  bool none = false;          // there is none but the floor, ceiling and outer walls of the viewers' region
  bool none_of_use = false;   // no other is large enough for the smallest cells
  double largest_area = 0.0;  // of the others, in square metres
  double size = 1.0;          // BakeSettings::occluder_size
  bool alone = true;          // nothing but a single convex occluder hides
};
std::optional<OccluderFacts> occludersOf(const BakeRecord& record);

bool beginsAsSightFile(const std::string& name);  // by its first bytes
bool isSightFile(const std::string& name);        // by its name or its first bytes

// Runs `info F.sight`. closed: the text of --closed.
Status informOnSight(const std::string& name, const std::string& closed, const std::string& json_target);

}  // namespace sightline::tool
