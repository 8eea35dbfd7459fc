#pragma once

// Comparing a box with planes through the eye and the edges of occluders. One occluder and one box take a few
// multiplications, so all occluders of a list are compared in one call.
//
// All positions are relative to the eye. Every instruction set gives the same bits.

#include <cstdint>
#include <span>

#include "src/occlusion/eye_box.h"

namespace sightline::occlusion {

// A bound of the rounding of a plane through the eye, relative to the distances involved.
inline constexpr double kEyePlane = 0x1p-36;

// The planes of four edges that are drawn in, with unit normals and the occluder behind them. Unused lanes
// have a zero normal and an offset that leaves everything behind them.
struct EyeQuad {
  double x[4] = {}, y[4] = {}, z[4] = {}, offset[4] = {kAllBehind, kAllBehind, kAllBehind, kAllBehind};

  static constexpr double kAllBehind = -1e300;
};

// An occluder's planes through the eye.
struct EyeShape {
  Vec3d normal;               // unit, towards the eye
  double offset = 0.0;        // of its plane
  double depth_margin = 0.0;  // metres by which a box must be behind it, in addition to kDepthMargin
  double reach = 0.0;         // largest l1Norm() of a corner, metres
  std::uint32_t first_quad = 0;
  std::uint16_t plane_count = 0;  // one for each edge, then one for the near plane's cut if there is one
};

// How a box compares with one occluder.
struct EyePlaneTest {
  bool touches = false;  // some of the box is behind the occluder's plane, and not all of it beyond an edge
  bool behind = false;   // all of it is behind the plane
  std::uint64_t failing = 0;  // planes beyond which some of it may be seen

  bool hidden() const { return behind && failing == 0; }
};

// Compares the box with the occluders of a list, shapes[list[i]] into tests[i], up to the first that hides
// it. Returns how many were compared. tests: at least as many as list.
std::size_t testAgainstEyePlanes(std::span<const EyeShape> shapes, std::span<const EyeQuad> quads,
                                 std::span<const std::uint32_t> list, const EyeBox& box,
                                 std::span<EyePlaneTest> tests);

}  // namespace sightline::occlusion
