#pragma once

// The directions along which parts are bounded. Where bounds do not overlap, neither part occludes the other.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sightline/math/vec3.h"

namespace sightline {

// One direction or plane along which parts are bounded. A spatial axis bounds the part's heights along a
// direction, an angular one the angles under which the eye sees the part in the plane of two directions.
// Source: Snyder, Lengyel. MSR-TR-97-11, section 5.
struct ExtentAxis {
  enum class Kind : std::uint8_t { kSpatial, kAngular };
  enum class Frame : std::uint8_t {
    kWorld,   // coordinates are the world's: spatial extents change only for parts that move
    kCamera,  // coordinates are along the view's right, up and forward
  };
  Kind kind = Kind::kSpatial;
  Frame frame = Frame::kWorld;
  // Any length > 0. On an angular axis: the direction of a quarter turn, perpendicular to `zero`.
  Vec3d direction{1, 0, 0};
  Vec3d zero{0, 0, 1};  // on an angular axis: the direction of angle 0
};

inline constexpr std::size_t kMaxExtentAxes = 16;

// Horizontal angle, vertical angle and depth, fixed to the camera. Best where most parts move.
std::vector<ExtentAxis> cameraExtents();
// The x, y and z axes of the world. Best where most parts stand still.
std::vector<ExtentAxis> worldExtents();

}  // namespace sightline
