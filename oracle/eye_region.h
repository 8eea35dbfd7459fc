#pragma once

// The places where an eye may be: a box, cut by planes.

#include <vector>

#include "oracle/split_mix.h"
#include "sightline/math/vec3.h"

namespace sightline {

// The points p with dot(normal, p) >= offset, as computed in double precision.
struct HalfSpace {
  Vec3d normal{};  // unit length
  double offset = 0.0;
};

// A closed convex region in scene space.
struct EyeRegion {
  Vec3d min{}, max{};  // finite
  std::vector<HalfSpace> sides{};

  bool contains(const Vec3d& point) const;
};

// A region with a point inside it, from which others are found.
class EyePlaces {
 public:
  explicit EyePlaces(EyeRegion region);

  // True if no point of the region was found: it is empty, or thinner than rounding.
  bool empty() const { return empty_; }
  const EyeRegion& region() const { return region_; }

  // A random point: anywhere, or on faces, edges and corners. Always in the region.
  Vec3d point(SplitMix& random) const;
  // The corner of the box, or the farthest point of the region towards it. i in [0, 8).
  Vec3d corner(std::uint32_t i) const;
  // The point of the region, exactly in it, next to a point that may be outside by rounding.
  Vec3d inside(const Vec3d& point) const;
  // The parameters t at which the line origin + t * direction is in the region, rounded. False if there are
  // none.
  bool interval(const Vec3d& origin, const Vec3d& direction, double& enter, double& leave) const;
  // All faces of the region as half-spaces.
  std::vector<HalfSpace> faces() const;

 private:
  bool findInner();
  Vec3d towards(const Vec3d& point) const;

  EyeRegion region_;
  Vec3d inner_{};
  bool empty_ = true;
};

}  // namespace sightline
