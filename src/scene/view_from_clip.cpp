// With the eye e and depths d = forward . (p - e), the rows of a perspective matrix are
//
//   w = q d                                       q > 0
//   x = (q / half_width) right . (p - e) - q shift_x d
//   z = a d + b                                   near = b / (z_near q - a), far = b / (z_far q - a)
//
// and y is like x. So the part of a row that is not along forward has the direction of an axis, and what is
// along forward is the shift. In an orthographic matrix w is constant.

#include "sightline/scene/view_from_clip.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace sightline {
namespace {

constexpr double kTilt = 0x1p-20;  // largest sine of angles that count as none: single precision is better

// A function of points p: normal . p + offset.
struct Row {
  Vec3d normal;
  double offset = 0.0;

  double length() const { return sightline::length(normal); }
  Row operator*(double s) const { return {normal * s, offset * s}; }
  Row operator-(const Row& other) const { return {normal - other.normal, offset - other.offset}; }
};

struct Rows {
  Row x, y, z, w;
};

Row rowOf(const Mat4& m, int row) {
  return {{m(row, 0), m(row, 1), m(row, 2)}, m(row, 3)};
}

// The point where each of the functions, of unit normals, is 0.
Vec3d commonPoint(const Row& a, const Row& b, const Row& c) {
  const Vec3d bc = cross(b.normal, c.normal), ca = cross(c.normal, a.normal), ab = cross(a.normal, b.normal);
  return (bc * a.offset + ca * b.offset + ab * c.offset) * (-1.0 / dot(a.normal, bc));
}

struct DepthRange {
  double near = 0.0, far = 0.0;  // z / w
};

DepthRange rangeOf(ClipDepth depth) {
  switch (depth) {
    case ClipDepth::kZeroToOne:
      return {0.0, 1.0};
    case ClipDepth::kOneToZero:
      return {1.0, 0.0};
    default:
      return {-1.0, 1.0};
  }
}

// A row as a unit normal times a scale, and what it has along forward.
struct Border {
  Row unit;
  double scale = 0.0, along = 0.0;
};

// Takes a row apart. along: the row of depths, unit normal.
std::optional<Border> borderOf(const Row& row, const Row& along) {
  Border border;
  border.along = dot(row.normal, along.normal);
  const Row across = row - along * border.along;
  border.scale = across.length();
  // A row along forward has nothing across but rounding.
  if (!(border.scale > 0x1p-40 * row.length())) {
    return std::nullopt;
  }
  border.unit = across * (1.0 / border.scale);
  return border;
}

Error notAProjection() {
  return Error{"clip_from_scene is not the matrix of a view: its rows x, y and w do not span space"};
}

bool tilted(const Vec3d& a, const Vec3d& b) {
  return std::abs(dot(a, b)) > kTilt;
}

Error tiltedDepths() {
  return Error{
      "clip_from_scene has an oblique near plane or a sheared depth: z does not depend on the distance along "
      "the viewing direction alone; give the matrix before its near plane was tilted, or call "
      "obliqueViewFromClip()"};
}

Error tiltedBorders() {
  return Error{"clip_from_scene is sheared: the borders of the picture are not at right angles"};
}

// The depth of the farthest point of the picture's corners on the far plane, which rounding in the matrix may
// have tilted: its row is the small difference of two large ones. Infinite where a corner's ray never meets
// it.
double farOf(const View& view, const Row& plane) {
  const double up = view.tan_half_fovy, right = up * view.aspect;
  const double at_eye = dot(plane.normal, view.eye) + plane.offset;
  double far = 0.0;
  for (const double x : {view.shift_x - 1.0, view.shift_x + 1.0}) {
    for (const double y : {view.shift_y - 1.0, view.shift_y + 1.0}) {
      const Vec3d ray = view.forward + view.right * (x * right) + view.up * (y * up);
      const double depth = -at_eye / dot(plane.normal, ray);
      far = depth >= 0.0 ? std::max(far, depth) : std::numeric_limits<double>::infinity();
    }
  }
  return far;
}

// A perspective view without its depths.
Result<View> perspectivePicture(const Rows& rows) {
  const double q = rows.w.length();
  const Row depth = rows.w * (1.0 / q);
  const std::optional<Border> x = borderOf(rows.x, depth), y = borderOf(rows.y, depth);
  if (!x || !y) {
    return notAProjection();
  }
  if (tilted(x->unit.normal, y->unit.normal)) {
    return tiltedBorders();
  }
  View view;
  view.forward = depth.normal;
  view.right = x->unit.normal;
  view.up = y->unit.normal;
  view.eye = commonPoint(x->unit, y->unit, depth);
  view.tan_half_fovy = q / y->scale;
  view.aspect = y->scale / x->scale;
  view.shift_x = -x->along / q;
  view.shift_y = -y->along / q;
  return view;
}

Result<View> perspectiveView(const Rows& rows, const DepthRange& range) {
  const Result<View> picture = perspectivePicture(rows);
  if (!picture) {
    return picture;
  }
  View view = *picture;
  const double q = rows.w.length();
  const Row depth = rows.w * (1.0 / q);
  const double a = dot(rows.z.normal, depth.normal);
  if (length(rows.z.normal - depth.normal * a) > kTilt * rows.z.length()) {
    return tiltedDepths();
  }
  // The value of row z at the eye: rounding may have tilted the row, so that its value at the origin says
  // nothing about the eye.
  const double b = dot(rows.z.normal, view.eye) + rows.z.offset;
  view.z_near = b / (range.near * q - a);
  view.z_far = farOf(view, rows.z - rows.w * range.far);
  if (!(view.z_near > 0.0 && std::isfinite(view.z_near))) {
    return Error{
        "clip_from_scene has no near plane in front of the eye: is ClipSpace::depth that of the matrix?"};
  }
  if (!(view.z_far > view.z_near)) {
    return Error{
        range.far > range.near
            ? "clip_from_scene has its far plane before its near plane: is ClipSpace::depth kOneToZero?"
            : "clip_from_scene has its far plane before its near plane: ClipSpace::depth is kOneToZero, "
              "but the matrix is not reversed"};
  }
  return view;
}

Result<View> orthographicView(const Rows& rows, const DepthRange& range) {
  const double w = rows.w.offset, scale = rows.z.length() / w;
  if (!(w > 0.0)) {
    return Error{"clip_from_scene is not the matrix of a view: its row w is not positive anywhere"};
  }
  if (!(scale > 0.0)) {
    return Error{"clip_from_scene is an orthographic projection without a depth range: z is constant"};
  }
  const double sign = range.far > range.near ? 1.0 : -1.0;
  const Row depth = rows.z * (sign / rows.z.length());
  const double x_scale = rows.x.length(), y_scale = rows.y.length();
  if (!(x_scale > 0.0 && y_scale > 0.0)) {
    return notAProjection();
  }
  const Row x = rows.x * (1.0 / x_scale), y = rows.y * (1.0 / y_scale);
  if (tilted(x.normal, y.normal)) {
    return tiltedBorders();
  }
  if (tilted(x.normal, depth.normal) || tilted(y.normal, depth.normal)) {
    return tiltedDepths();
  }
  View view;
  view.orthographic = true;
  view.right = x.normal;
  view.up = y.normal;
  view.forward = depth.normal;
  Row near = depth;
  near.offset -= sign * range.near / scale;
  view.eye = commonPoint(x, y, near);
  view.ortho_height = 2.0 * w / y_scale;
  view.aspect = y_scale / x_scale;
  view.z_near = 0.0;
  view.z_far = std::abs(range.far - range.near) / scale;
  return view;
}

// The depth of the nearest point of the picture's volume that is on the positive side of a plane: it lies on
// a corner's ray, since reciprocal depth is linear over the picture. 0 if the eye is on that side; infinite
// if there is no such point.
double nearestBeyond(const View& view, const Row& plane) {
  const double at_eye = dot(plane.normal, view.eye) + plane.offset;
  const double up = view.tan_half_fovy, right = up * view.aspect;
  double most = 0.0;
  for (const double x : {view.shift_x - 1.0, view.shift_x + 1.0}) {
    for (const double y : {view.shift_y - 1.0, view.shift_y + 1.0}) {
      most = std::max(most, dot(plane.normal, view.forward + view.right * (x * right) + view.up * (y * up)));
    }
  }
  return at_eye >= 0.0 ? 0.0 : -at_eye / most;
}

constexpr double kNearTolerance = 0.01;  // see ClipSpace::z_near

Result<Rows> rowsOf(const Mat4& clip_from_scene, const ClipSpace& clip_space) {
  const auto finite = [](double value) { return std::isfinite(value); };
  if (!std::all_of(clip_from_scene.m.begin(), clip_from_scene.m.end(), finite)) {
    return Error{"clip_from_scene must be finite"};
  }
  Rows rows{rowOf(clip_from_scene, 0), rowOf(clip_from_scene, 1), rowOf(clip_from_scene, 2),
            rowOf(clip_from_scene, 3)};
  rows.y = clip_space.y_down ? rows.y * -1.0 : rows.y;
  return rows;
}

}  // namespace

Result<ObliqueView> obliqueViewFromClip(const Mat4& clip_from_scene, const ClipSpace& clip_space) {
  const Result<Rows> rows = rowsOf(clip_from_scene, clip_space);
  if (!rows) {
    return rows.error();
  }
  const Result<View> picture = rows->w.length() > 0.0 ? perspectivePicture(*rows) : notAProjection();
  if (!picture) {
    return picture.error();
  }
  const DepthRange range = rangeOf(clip_space.depth);
  const Row beyond = (rows->z - rows->w * range.near) * (range.far > range.near ? 1.0 : -1.0);
  const double size = beyond.length();
  if (!(size > 0.0)) {
    return Error{"clip_from_scene has no near plane: is ClipSpace::depth that of the matrix?"};
  }
  const Row plane = beyond * (1.0 / size);
  ObliqueView oblique{*picture, {plane.normal, plane.offset}};
  constexpr double kRounding = 1e-9;
  oblique.view.z_near = (1.0 - kRounding) * nearestBeyond(oblique.view, plane);
  oblique.view.z_far = std::numeric_limits<double>::infinity();
  if (!std::isfinite(oblique.view.z_near)) {
    return Error{"clip_from_scene has its near plane behind all that is in the picture"};
  }
  const Result<View> valid = validate(oblique.view);
  if (!valid) {
    return valid.error();
  }
  oblique.view = *valid;
  return oblique;
}

Result<View> viewFromClip(const Mat4& clip_from_scene, const ClipSpace& clip_space) {
  const Result<Rows> taken = rowsOf(clip_from_scene, clip_space);
  if (!taken) {
    return taken.error();
  }
  const Rows& rows = *taken;
  const DepthRange range = rangeOf(clip_space.depth);
  // Row w of an orthographic projection may have some rounding in it, and then changes hardly over the range
  // of depths.
  constexpr double kConstant = 0x1p-40;
  const bool perspective = rows.w.length() * std::abs(range.far - range.near) > kConstant * rows.z.length();
  const Result<View> view = perspective ? perspectiveView(rows, range) : orthographicView(rows, range);
  if (!view) {
    return view;
  }
  if (perspective && clip_space.z_near > 0.0 &&
      !(std::abs(view->z_near - clip_space.z_near) <= kNearTolerance * clip_space.z_near)) {
    return Error{"clip_from_scene has its near plane at a distance of " + std::to_string(view->z_near) +
                 ", ClipSpace::z_near says " + std::to_string(clip_space.z_near) +
                 ": is ClipSpace::depth that of the matrix?"};
  }
  return validate(*view);
}

}  // namespace sightline
