#pragma once

// Where viewers can be, as boxes for BakeSettings::viewers: sets for the sky, for the inside of solids and
// for rooms that nobody can enter take time and memory to no use. A viewer who is elsewhere after all gets
// the set of all objects, so no choice here can hide anything that is visible.

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "sightline/base/parallel_for.h"
#include "sightline/base/result.h"
#include "sightline/math/box.h"
#include "sightline/scene/scene.h"

namespace sightline {

// Boxes that together hold everything within `reach` metres, along each axis, of the straight lines between
// neighbouring eyes, scene space. Eyes that are not finite are omitted.
std::vector<Box> boxesAlong(std::span<const Vec3d> eyes, double reach);

struct FreeSpaceSettings {
  static constexpr std::uint64_t kMaxVoxels = 1u << 27;
  static constexpr double kUsualVoxel = 0.25;  // metres
  // Edge of the voxels, metres; 0: kUsualVoxel, or what kMaxVoxels voxels allow. Gaps narrower than about two
  // voxels may count as closed.
  double voxel = 0.0;
  // Viewers are at most so many metres above (y) the opaque triangles below them.
  double max_height = std::numeric_limits<double>::infinity();
  Box region{};  // searched, scene space; empty: the bounds of the scene
};

struct FreeSpace {
  std::vector<Box> boxes{};  // scene space; they meet only at their sides
  double voxel = 0.0;        // edge of the voxels, metres
};

// The space that can be reached from these points, scene space, without crossing an opaque triangle: voxels
// that touch none and are connected by their faces, and a layer of voxels around them, so that all of a room
// up to its walls is found. A point whose own voxel is not free starts from all of the nearest free ones, at
// most two voxels away, on whichever side of a wall they are, and its own surroundings belong to the result
// as well. The same input gives the same boxes. Returns an error if no start is near a free voxel of the
// region, or if settings are out of range.
Result<FreeSpace> findFreeSpace(const SceneView& scene, std::span<const Vec3d> from,
                                const FreeSpaceSettings& settings = {},
                                const ParallelFor& parallel_for = serialFor);

}  // namespace sightline
