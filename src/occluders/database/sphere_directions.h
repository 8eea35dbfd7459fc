#pragma once

// Directions spread evenly over the sphere, with a table that finds the nearest of them in constant time.

#include <cstdint>
#include <vector>

#include "sightline/math/vec3.h"
#include "src/base/rows.h"

namespace sightline::occluders {

inline constexpr std::uint32_t kMaxDirections = 4096;

class SphereDirections {
 public:
  // count is clamped to [1, kMaxDirections].
  explicit SphereDirections(std::uint32_t count);

  std::uint32_t count() const { return static_cast<std::uint32_t>(directions_.size()); }
  const Vec3d& operator[](std::uint32_t index) const { return directions_[index]; }

  // The index of the direction with the largest cosine, of several the lowest: what trying all directions
  // would find, up to the rounding of one scalar product. The argument may have any length; zero and what is
  // not finite give 0. Tries only the directions listed for one texel of a cube, about three.
  std::uint32_t nearest(const Vec3d& direction) const;

  // Bounds the angle between any direction and its nearest one, in radians. The bound is too large by at most
  // 2 % of 2 / sqrt(count).
  double coveringAngleRad() const { return covering_angle_; }

  std::size_t bytes() const;  // beside the object itself

 private:
  struct Quad;
  void buildTable();
  void appendCandidates(const Quad& texel);
  double boundCoveringAngle() const;

  std::vector<Vec3d> directions_;  // unit
  // The directions that can be nearest in each texel of a cube [-1, 1]^3 with texels_per_edge_^2 texels a
  // face, ascending.
  std::uint32_t texels_per_edge_ = 1;
  base::Rows<std::uint16_t> candidates_;
  double covering_angle_ = 0.0;
};

}  // namespace sightline::occluders
