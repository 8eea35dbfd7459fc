#pragma once

// Makes convex polygons of the triangles of one object, for findOccluders() and makeOccluders().

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sightline/math/plane.h"
#include "sightline/math/vec3.h"

namespace sightline::occluders {

// A convex polygon over shared vertices, before ranking.
struct FoundPolygon {
  std::vector<std::uint32_t> loop;     // vertex ids along the whole boundary, counter-clockwise
  std::vector<std::uint32_t> corners;  // positions in loop where the boundary turns
  Plane plane;                         // unit normal
  Vec3d centroid;
  double area = 0.0;
  double slack = 0.0;
  std::uint32_t triangle_count = 0;
  bool double_sided = false;

  static constexpr std::uint32_t kNoBody = 0xffffffffu;
  std::uint32_t body = kNoBody;  // of the object's bodies, see bodies.h
  std::uint32_t body_size = 0;   // polygons that it has
};

// Places count as equal when they differ by no more than this: eight units in the last place of
// single-precision coordinates of that size.
double roundingTolerance(double largest_coordinate);

// A coplanar, connected set of triangles, consistently wound.
struct Patch {
  Plane plane;
  double deviation = 0.0;  // largest distance of a vertex from the plane
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

struct PatchResult {
  std::vector<Patch> patches;
  std::uint64_t degenerate = 0;  // triangles left out
};

// Cuts the triangles (vertex ids into positions) into patches.
PatchResult findPatches(std::span<const Vec3f> positions, std::span<const std::uint32_t> indices,
                        bool double_sided, double tolerance);

// Merges a patch's triangles to convex polygons that can't be merged any further, each with at most
// max_vertices corners.
std::vector<FoundPolygon> mergePatch(std::span<const Vec3f> positions, const Patch& patch, double tolerance,
                                     std::uint32_t max_vertices);

// Fills corners, area, centroid and slack from loop and plane; false when the loop is not convex within the
// tolerance or has more than max_vertices corners.
bool finishPolygon(std::span<const Vec3f> positions, double tolerance, std::uint32_t max_vertices,
                   FoundPolygon& polygon);

}  // namespace sightline::occluders
