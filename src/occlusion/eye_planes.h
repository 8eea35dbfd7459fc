#pragma once

// Planes through the eye and the edges of occluders, and what they say of a box. One occluder and one box
// take a few multiplications, so this is done for all occluders of a list at once.
//
// All positions are relative to the eye. Every instruction set gives the same bits.

#include <cstdint>
#include <span>

#include "src/occlusion/eye_box.h"

namespace sightline::occlusion {

// Rounding of a plane through the eye, times the distances involved.
inline constexpr double kEyePlane = 0x1p-36;

// Planes of four edges, drawn in; unit normals, the occluder behind them. Unused lanes are zero, with an
// offset that leaves everything behind them.
struct EyeQuad {
  double x[4] = {}, y[4] = {}, z[4] = {}, offset[4] = {kAllBehind, kAllBehind, kAllBehind, kAllBehind};

  static constexpr double kAllBehind = -1e300;
};

// An occluder.
struct EyeShape {
  Vec3d normal;               // unit, towards the eye
  double offset = 0.0;        // of its plane
  double depth_margin = 0.0;  // metres that a box must be behind it, in addition to kDepthMargin
  double reach = 0.0;         // largest magnitude of a corner
  std::uint32_t first_quad = 0;
  std::uint16_t plane_count = 0;  // one for each edge, then one for the near plane's cut if there is one
};

struct EyePlaneTest {
  bool touches = false;  // some of the box is behind the occluder's plane, and not all of it beyond an edge
  bool behind = false;   // all of it is behind the plane
  std::uint64_t failing = 0;  // planes beyond which some of it may be seen

  bool hidden() const { return behind && failing == 0; }
};

// Looks at the box past the occluders of a list, shapes[list[i]] in tests[i], up to the first that hides it.
// Returns how many were looked at.
std::size_t testAgainstEyePlanes(std::span<const EyeShape> shapes, std::span<const EyeQuad> quads,
                                 std::span<const std::uint32_t> list, const EyeBox& box,
                                 std::span<EyePlaneTest> tests);

}  // namespace sightline::occlusion
