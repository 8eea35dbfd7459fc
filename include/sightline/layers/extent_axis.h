#pragma once

// The directions along which parts are bounded, to tell quickly that one cannot occlude another.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sightline/math/vec3.h"

namespace sightline {

// Spatial: the interval of a part along a direction. Angular: the interval of angles under which the eye sees
// it in the plane of two directions, periodic. Source: Snyder, Lengyel. MSR-TR-97-11, section 5.
struct ExtentAxis {
  enum class Kind : std::uint8_t { kSpatial, kAngular };
  enum class Frame : std::uint8_t {
    kWorld,   // fixed: spatial extents change for parts that move, and for no others
    kCamera,  // coordinates are along the view's right, up and forward
  };
  Kind kind = Kind::kSpatial;
  Frame frame = Frame::kWorld;
  Vec3d direction{1, 0,
                  0};   // spatial: any length > 0. Angular: that of a quarter turn, perpendicular to zero
  Vec3d zero{0, 0, 1};  // angular: the direction of angle 0
};

inline constexpr std::size_t kMaxExtentAxes = 16;

// Horizontal and vertical angle and depth, fixed to the camera: for scenes in which most parts move.
std::vector<ExtentAxis> cameraExtents();
// x, y and z of the world: for scenes in which most parts stand still.
std::vector<ExtentAxis> worldExtents();

}  // namespace sightline
