#include "tools/sightline/bake/bake_warning.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace sightline::tool {
namespace {

// Sets that keep this share of the scene's triangles, in the mean over space and over cells, are of no use.
constexpr double kKeepsAll = 0.9;
// Where single convex occluders leave this share, more may be hidden in more time.
constexpr double kKeepsMost = 0.7;
constexpr double kMaxOfSpace = 0.5;

double shareOf(const SightFacts& facts, StopReason reason) {
  return facts.reason_volumes[static_cast<std::size_t>(reason)];
}

// The smallest depth whose cells are small enough for the largest occluder; 0 if there is none.
std::uint32_t depthFor(const OccluderFacts& occluders, double root_edge, double occluder_size) {
  for (std::uint32_t depth = 0; depth <= kMaxOctreeDepth; ++depth) {
    const double edge = std::ldexp(root_edge, -static_cast<int>(depth));
    if (occluder_size * edge * edge <= occluders.largest_area) {
      return depth;
    }
  }
  return 0;
}

std::string reasonFor(const SightFile& file, const SightFacts& facts) {
  const BakeRecord& record = file.record();
  const OctreeView octree = file.octree();
  const double root_edge = octree.max.x - octree.min.x;
  const double edge = std::ldexp(root_edge, -static_cast<int>(record.max_depth));
  const std::optional<OccluderFacts> occluders = occludersOf(record);
  if (file.scene().objects == 1) {
    return "the scene is one object, and an object is kept or left out as a whole; give it in several "
           "objects";
  }
  if (occluders && occluders->none) {
    return "nothing in the scene can occlude: no face or solid of opaque triangles lies among the viewers";
  }
  if (file.scene().triangles <= record.triangle_budget ||
      shareOf(facts, StopReason::kBudgetMet) >= kMaxOfSpace) {
    return fmt::format(
        "cells from which {} triangles or fewer may be seen are not divided; give a smaller "
        "--triangle-budget",
        record.triangle_budget);
  }
  if (record.near_distance >= edge) {
    return fmt::format(
        "what is within the near distance of a cell does not occlude, and {:g} m is more than the smallest "
        "cells' {:.3g} m; give a smaller --near-distance",
        record.near_distance, edge);
  }
  if (occluders && occluders->none_of_use) {
    const std::uint32_t depth = depthFor(*occluders, root_edge, occluders->size);
    return fmt::format(
        "the largest occluder has {:.3g} m², too small for the smallest cells, {:.3g} m wide; {}",
        occluders->largest_area, edge,
        depth > record.max_depth ? fmt::format("give --depth {} or more, or say where --viewers are", depth)
                                 : "give a smaller --occluder-size");
  }
  if (shareOf(facts, StopReason::kMaxDepth) >= kMaxOfSpace && record.max_depth < kMaxOctreeDepth) {
    return fmt::format(
        "the smallest cells are {:.3g} m wide; give a --depth greater than {}, or say where "
        "--viewers are",
        edge, record.max_depth);
  }
  if (!occluders || occluders->alone) {
    return "single convex occluders hide little here: the scene is open, or its walls are of many small "
           "pieces, which --occlusion fused lets hide together";
  }
  return "surfaces hide little here: the scene is open, or whole rooms lie in one cell";
}

}  // namespace

std::string bakeWarning(const SightFile& file, const SightFacts& facts) {
  const auto triangles = static_cast<double>(file.scene().triangles);
  const double in_space = facts.mean_triangles_by_volume / triangles;
  const double in_cells = facts.sizes.triangles.mean / triangles;
  if (in_space > kKeepsAll && in_cells > kKeepsAll) {
    return fmt::format("the sets are of little use: they keep {:.0f} % of the triangles; {}",
                       100.0 * in_space, reasonFor(file, facts));
  }
  const std::optional<OccluderFacts> occluders = occludersOf(file.record());
  if (in_space > kKeepsMost && in_cells > kKeepsMost && occluders && occluders->alone) {
    return fmt::format(
        "the sets keep {:.0f} % of the triangles; --occlusion fused lets walls of many small pieces hide "
        "together, and a greater --depth makes smaller cells",
        100.0 * in_space);
  }
  return {};
}

}  // namespace sightline::tool
