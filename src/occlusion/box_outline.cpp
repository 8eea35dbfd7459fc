// All is computed in double precision, relative to the eye.
//
// A ray through the place (X, Y) of the buffer has the direction r = tx right + ty up + forward, where
// tx = (X - middle_x) / scale_x, ty likewise; right, up and forward are PixelView's unit_x, unit_y, unit_z.
//
//   Edge along the axis e through the corner a:  the plane through the eye has the normal n = a x e, which
//     takes no subtraction; the box is where n . r >= 0. Orthographic: n = forward x e, and n . (tx right +
//     ty up - a) >= 0.
//   Face at l metres from the eye along the axis e:  1 / depth = (e . r) / l. Orthographic:
//     -depth = (e . (tx right + ty up) - l) / (e . forward).
//
// Each is a sum of three terms, with a few roundings in every one.

#include "src/occlusion/box_outline.h"

#include <bit>
#include <cmath>

#include "src/geometry/box_tangents.h"
#include "src/occlusion/eye_box.h"

namespace sightline::occlusion {
namespace {

constexpr double kWideRounding = 0x1p-48;    // of the terms in double precision, with a factor of 8
constexpr double kSingleRounding = 0x1p-21;  // of coefficients, products and sums in single precision: 5 u
constexpr double kTooLarge = 1e30;           // functions beyond this say nothing

// The origin of the functions, and how far from it they are evaluated.
struct Origin {
  double tx, ty;        // at the origin
  double per_x, per_y;  // change of tx and ty for a pixel
  double reach;         // pixels
  double extent;        // a bound of |tx| + |ty| + 1 within reach
};

Origin originAt(const PixelView& view, std::uint32_t x, std::uint32_t y, double reach) {
  Origin o;
  o.per_x = 1.0 / view.scale_x;
  o.per_y = 1.0 / view.scale_y;
  o.tx = (x - view.middle_x) * o.per_x;
  o.ty = (y - view.middle_y) * o.per_y;
  o.reach = reach;
  o.extent = std::abs(o.tx) + std::abs(o.ty) + (o.per_x + o.per_y) * reach + 1.0;
  return o;
}

// Makes the function f.x tx + f.y ty + f.z. size: a bound of the sum of the terms in each of the three.
// False: the values are too large for single precision.
bool bounded(const Origin& o, const Vec3d& f, double size, PixelFunction& out) {
  const double along_x = f.x * o.per_x, along_y = f.y * o.per_y;
  const double at_origin = f.x * o.tx + f.y * o.ty + f.z;
  const double wide = size * o.extent;
  const double single = (std::abs(along_x) + std::abs(along_y)) * o.reach + std::abs(at_origin);
  if (!(wide < kTooLarge && single < kTooLarge)) {
    return false;
  }
  const double rounding = kWideRounding * wide + kSingleRounding * single;
  out.along_x = static_cast<float>(along_x);
  out.along_y = static_cast<float>(along_y);
  // The smallest numbers of single precision are coarse; they are far below any of a scene.
  out.at_origin = static_cast<float>(at_origin + rounding + 0x1p-120);
  return true;
}

Vec3d crossedWith(const Vec3d& v, int axis) {
  return axis == 0 ? Vec3d(0.0, v.z, -v.y) : axis == 1 ? Vec3d(-v.z, 0.0, v.x) : Vec3d(v.y, -v.x, 0.0);
}

int regionOfEye(const PixelView& view, const EyeBox& box) {
  if (!view.orthographic) {
    return geometry::regionOfOrigin(box.min, box.max);
  }
  // An eye infinitely far behind.
  const auto digit = [](double forward) { return forward > 0.0 ? 1 : forward < 0.0 ? 2 : 0; };
  return digit(view.unit_z.x) + 3 * digit(view.unit_z.y) + 9 * digit(view.unit_z.z);
}

void addEdge(const PixelView& view, const Origin& origin, const Vec3d& corner, int axis, double sign,
             BoxOutline& outline) {
  const Vec3d n = crossedWith(view.orthographic ? view.unit_z : corner, axis) * sign;
  const Vec3d f(dot(n, view.unit_x), dot(n, view.unit_y),
                view.orthographic ? -dot(n, corner) : dot(n, view.unit_z));
  // The axes are as good as unit vectors. Orthographic: what they are off by counts by the distance from the
  // eye, however short the normal is.
  const double size = view.orthographic ? 2.0 * (1.0 + l1Norm(corner)) : l1Norm(n);
  if (bounded(origin, f, size, outline.edges[outline.edge_count])) {
    ++outline.edge_count;
  }
}

// farthest: a bound of the distance of the box's corners from the eye, metres.
void addFace(const PixelView& view, const Origin& origin, int axis, double distance, double farthest,
             BoxOutline& outline) {
  const double scale = 1.0 / (view.orthographic ? view.unit_z[axis] : distance);
  const Vec3d f =
      Vec3d(view.unit_x[axis], view.unit_y[axis], view.orthographic ? -distance : view.unit_z[axis]) * scale;
  const double size = view.orthographic ? std::abs(scale) * (1.0 + farthest) : maxComponent(abs(f));
  if (bounded(origin, f, size, outline.faces[outline.face_count])) {
    ++outline.face_count;
  }
}

}  // namespace

BoxOutline outlineOf(const PixelView& view, const Box& box, std::uint32_t x, std::uint32_t y, double reach) {
  const EyeBox eye_box = EyeBox::of(box, view.eye);
  const Origin origin = originAt(view, x, y, reach);
  BoxOutline outline;
  int region = regionOfEye(view, eye_box);
  const geometry::Silhouette& loop = geometry::silhouetteFrom(region);
  for (int i = 0; i < loop.count; ++i) {
    const auto from = loop.corners[static_cast<std::size_t>(i)];
    const auto to = loop.corners[static_cast<std::size_t>(i + 1 < loop.count ? i + 1 : 0)];
    const int axis = std::countr_zero(static_cast<unsigned>(from ^ to));
    const double sign = to > from ? 1.0 : -1.0;
    addEdge(view, origin, geometry::cornerOf(eye_box.min, eye_box.max, from), axis, sign, outline);
  }
  for (int axis = 0; axis < 3; ++axis, region /= 3) {
    if (region % 3 != 0) {
      const double distance = region % 3 == 1 ? eye_box.min[axis] : eye_box.max[axis];
      addFace(view, origin, axis, distance, eye_box.farthest(), outline);
    }
  }
  return outline;
}

}  // namespace sightline::occlusion
