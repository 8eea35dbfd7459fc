#pragma once

#include "sightline/math/vec3.h"
#include "sightline/scene/camera.h"

namespace sightline::drawing {

// Which sides of triangles a view sees.
class TriangleSides {
 public:
  explicit TriangleSides(const View& view);

  // 1: the triangle's front (counter-clockwise), -1: its back, 0: neither. The view sees neither if the eye
  // lies in the triangle's plane within the rounding of double precision, or if the triangle has no area or
  // is not finite.
  int seen(const Vec3f& a, const Vec3f& b, const Vec3f& c) const;

 private:
  bool orthographic_;
  Vec3d eye_;
  Vec3d sight_;  // orthographic: the direction of the lines of sight
};

}  // namespace sightline::drawing
