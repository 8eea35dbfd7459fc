// Based on: Snyder, Lengyel. MSR-TR-97-11, appendix C.
// Differs from the paper in: the cone is not tested by its apex, which lies at l = s^2 / h and so moves to
// infinity as the cylinder becomes as thick as the sphere. The eye sees no point of the rim if it lies behind
// the sphere's tangent plane in each of them. Let e be the eye relative to the centre, a its height along V,
// and rho its distance from the axis. The plane in the rim's point h V + r u has the normal h V + r u and the
// offset s^2. Over all unit vectors u across V the condition is
//   h a + r rho <= s^2,
// which is the paper's cone without the part beyond the apex, and for r = s the cylinder rho <= s. For an eye
// at infinity in the direction D, e = D and 0 replaces s^2.

#include "sightline/layers/pair_rule.h"

#include <cmath>
#include <limits>

#include "sightline/geometry/tolerance.h"
#include "src/layers/pairs/pair_eye.h"

namespace sightline {
namespace layers {
namespace {

// Relative to the coordinates; some hundred times the rounding error of the sums below.
constexpr double kBand = 1e-12;
// Products below this lose digits to underflow.
constexpr double kTiny = std::numeric_limits<double>::min() * 0x1p60;

constexpr PairOrder kFirstOnly{true, false};
constexpr PairOrder kSecondOnly{false, true};
constexpr PairOrder kBoth{true, true};

// Normalizes a vector of any length; the result is not finite if there is none.
Vec3d unit(const Vec3d& direction) {
  const Vec3d scaled = direction / maxComponent(abs(direction));
  return scaled / length(scaled);
}

}  // namespace

PairEye pairEye(const View& view_in_part) {
  PairEye eye;
  eye.far = view_in_part.orthographic;
  eye.position = eye.far ? -unit(view_in_part.forward) : view_in_part.eye;
  eye.extent = l1Norm(eye.position);
  eye.known = std::isfinite(eye.extent);
  eye.error = kBand * eye.extent;
  return eye;
}

PairEye pairEye(const View& view_world, const Placement& world_from_part) {
  const Placement& p = world_from_part;
  // The rows of the inverse, times the determinant.
  const Vec3d row_x = cross(p.y, p.z), row_y = cross(p.z, p.x), row_z = cross(p.x, p.y);
  const double determinant = dot(p.x, row_x);
  const bool far = view_world.orthographic;
  const Vec3d from_origin = far ? -view_world.forward : view_world.eye - p.origin;
  const Vec3d local =
      Vec3d(dot(row_x, from_origin), dot(row_y, from_origin), dot(row_z, from_origin)) / determinant;

  const double x = l1Norm(p.x), y = l1Norm(p.y), z = l1Norm(p.z);
  const double reach = far ? l1Norm(view_world.forward) : l1Norm(view_world.eye) + l1Norm(p.origin);
  const double volume = std::abs(determinant);
  const double error = kBand * (1.0 + x * y * z / volume) * (x * y + y * z + z * x) * reach / volume;
  PairEye eye;
  eye.far = far;
  eye.position = far ? unit(local) : local;
  eye.error = far ? error / length(local) + kBand : error;
  eye.extent = l1Norm(eye.position);
  eye.known = std::isfinite(eye.extent) && std::isfinite(eye.error);
  return eye;
}

PairOrder orderOf(const PairPlane& known, const PairEye& eye) {
  const Plane& plane = known.plane;
  const double steep = l1Norm(plane.normal);
  if (!eye.known || !(steep > 0.0)) {
    return kBoth;
  }
  const double offset = eye.far ? 0.0 : plane.offset;
  const double height = dot(plane.normal, eye.position) + offset;
  const double band = kBand * (steep * eye.extent + std::abs(offset)) + steep * eye.error + kTiny;
  return height > band ? kFirstOnly : height < -band ? kSecondOnly : kBoth;
}

PairOrder orderOf(const SphereCylinderJoint& joint, const PairEye& eye) {
  const double s = joint.sphere_radius, r = joint.cylinder_radius;
  const Vec3d axis = unit(joint.axis);
  if (!eye.known || !(r > 0.0 && r <= s) || !std::isfinite(s) || !isFinite(axis) || !isFinite(joint.centre)) {
    return kBoth;
  }
  const Vec3d e = eye.far ? eye.position : eye.position - joint.centre;
  const double reach = eye.extent + (eye.far ? 0.0 : l1Norm(joint.centre));
  const double h = std::sqrt((s - r) * (s + r));
  const double along = dot(axis, e);               // a
  const double across = length(e - axis * along);  // rho
  const double rim = eye.far ? 0.0 : h;            // height of the rim's plane along the axis
  const double tangent = eye.far ? 0.0 : s * s;
  const double moved =
      eye.error + kBand * (reach + s) + kTiny;  // bound of the error of along, across and rim
  if (!eye.far && !(length(e) > s + moved)) {
    return kBoth;
  }
  if (along > rim + moved) {
    return kSecondOnly;
  }
  const bool hides_rim = h * along + r * across < tangent - (h + r) * moved - kBand * tangent;
  return along < rim - moved && hides_rim ? kFirstOnly : kBoth;
}

}  // namespace layers

PairOrder orderOf(const PairPlane& known, const View& view_in_first) {
  return layers::orderOf(known, layers::pairEye(view_in_first));
}

PairOrder orderOf(const SphereCylinderJoint& joint, const View& view_in_first) {
  return layers::orderOf(joint, layers::pairEye(view_in_first));
}

}  // namespace sightline
