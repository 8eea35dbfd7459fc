#include "src/occlusion/box_point.h"

#include <algorithm>

#include "src/occlusion/eye_box.h"

namespace sightline::occlusion {

bool pointInPixel(const PixelView& view, const Box& box, const BufferPixel& pixel, Vec3f& point) {
  const EyeBox eye_box = EyeBox::of(box, view.eye);
  const Vec3d across = view.unit_x * ((pixel.x + 0.5 - view.middle_x) / view.scale_x) +
                       view.unit_y * ((pixel.y + 0.5 - view.middle_y) / view.scale_y);
  // Points of the ray are origin + depth * direction, relative to the eye.
  const Vec3d origin = view.orthographic ? across : Vec3d();
  const Vec3d direction = view.orthographic ? view.unit_z : across + view.unit_z;
  double begin = view.near, end = view.far;
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0) {
      if (!(origin[axis] >= eye_box.min[axis] && origin[axis] <= eye_box.max[axis])) {
        return false;
      }
      continue;
    }
    const double a = (eye_box.min[axis] - origin[axis]) / direction[axis];
    const double b = (eye_box.max[axis] - origin[axis]) / direction[axis];
    begin = std::max(begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
  }
  if (!(begin <= end)) {
    return false;
  }
  const Vec3f rounded(view.eye + origin + direction * begin);
  point = max(box.min, min(rounded, box.max));
  return true;
}

}  // namespace sightline::occlusion
