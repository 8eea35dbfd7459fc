#include "src/drawing/triangle_side.h"

#include "src/scene/usable_view.h"

namespace sightline::drawing {

TriangleSides::TriangleSides(const View& view) : orthographic_(view.orthographic), eye_(view.eye) {
  if (orthographic_) {
    sight_ = scene::sightDirection(scene::withUnitAxes(view));
  }
}

// The sign of dot(n, v) with n = (b - a) x (c - a) and v the vector from the eye to a. The differences b - a
// and a - eye are off by 2^-53 of their size each; six products and five sums follow. So the value is off by
// less than 2^-49 times the product of the largest components (six terms, eight roundings each). In an
// orthographic view, v is a direction that is off by 2^-48 of its length (sightDirection), which adds less
// than 2^-44.
int TriangleSides::seen(const Vec3f& a, const Vec3f& b, const Vec3f& c) const {
  const Vec3d ab = Vec3d(b) - Vec3d(a);
  const Vec3d ac = Vec3d(c) - Vec3d(a);
  const Vec3d sight = orthographic_ ? sight_ : Vec3d(a) - eye_;
  const double value = dot(cross(ab, ac), sight);
  const double rounding = orthographic_ ? 0x1p-43 : 0x1p-47;
  const double bound = rounding * maxComponent(abs(ab)) * maxComponent(abs(ac)) * maxComponent(abs(sight));
  return value < -bound ? 1 : value > bound ? -1 : 0;
}

}  // namespace sightline::drawing
