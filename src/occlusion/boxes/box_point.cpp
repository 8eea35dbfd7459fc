#include "src/occlusion/boxes/box_point.h"

#include <algorithm>
#include <limits>

#include "src/occlusion/eye_box.h"

namespace sightline::occlusion {
namespace {

// Points of a ray are origin + depth * direction, relative to the eye.
struct Ray {
  Vec3d origin, direction;

  Vec3d at(double depth) const { return origin + direction * depth; }
  double depthOfNearest(const Vec3d& point) const {
    return dot(point - origin, direction) / dot(direction, direction);
  }
};

Ray rayThrough(const scene::PixelView& view, const BufferPixel& pixel) {
  const Vec3d across = view.unit_x * ((pixel.x + 0.5 - view.middle_x) / view.scale_x) +
                       view.unit_y * ((pixel.y + 0.5 - view.middle_y) / view.scale_y);
  return view.orthographic ? Ray{across, view.unit_z} : Ray{{}, across + view.unit_z};
}

// The depths, not before the near plane, between which a ray is in a box. It misses the box where begin is
// greater than end.
struct Stretch {
  double begin, end;
};

Stretch stretchIn(const EyeBox& box, const Ray& ray, double near) {
  Stretch stretch{near, std::numeric_limits<double>::infinity()};
  for (int axis = 0; axis < 3; ++axis) {
    // A ray along a face may give what is no number, which the comparisons leave out.
    const double a = (box.min[axis] - ray.origin[axis]) / ray.direction[axis];
    const double b = (box.max[axis] - ray.origin[axis]) / ray.direction[axis];
    stretch.begin = std::max(stretch.begin, std::min(a, b));
    stretch.end = std::min(stretch.end, std::max(a, b));
  }
  return stretch;
}

// Moves to and fro between the ray and the box, closer each time.
Vec3d pointNear(const EyeBox& box, const Ray& ray) {
  constexpr int kSteps = 3;
  Vec3d point = box.center();
  for (int step = 0; step < kSteps; ++step) {
    point = max(box.min, min(ray.at(ray.depthOfNearest(point)), box.max));
  }
  return point;
}

}  // namespace

Vec3f pointInPixel(const scene::PixelView& view, const Box& box, const BufferPixel& pixel) {
  const EyeBox eye_box = EyeBox::of(box, view.eye);
  const Ray ray = rayThrough(view, pixel);
  const Stretch stretch = stretchIn(eye_box, ray, view.near);
  const Vec3d point = stretch.begin <= stretch.end ? ray.at(stretch.begin) : pointNear(eye_box, ray);
  return max(box.min, min(Vec3f(view.eye + point), box.max));
}

}  // namespace sightline::occlusion
