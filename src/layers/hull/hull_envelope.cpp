// The covariance matrix C of the vertices around their mean is L L^T with a lower triangular L (Cholesky).
// With the columns of L as axes, a vertex v lies at w = L^-1 (v - mean), and the ellipsoid is scaled by the
// length of the longest w. It must also contain a ball of the hull's slack and the rounding error around each
// vertex. An axis longer by r makes the ellipsoid higher by less than r, so each axis is lengthened along
// itself by the ball's radius in units of the shortest axis.

#include "src/layers/hull/hull_envelope.h"

#include <algorithm>
#include <limits>

#include "sightline/geometry/tolerance.h"

namespace sightline::layers {
namespace {

// The thinnest axis relative to the hull's radius; thinner ones are thickened so that they can be divided by.
constexpr double kThinnest = 1e-6;
// Relative to the radius; far above the rounding error of the sums below, which the division by the thinnest
// axis multiplies by 1e6.
constexpr double kRounding = 1e-8;
// Squares of smaller hulls' coordinates would underflow.
constexpr double kMinRadius = 1e-100;

struct Covariance {
  double xx = 0.0, xy = 0.0, xz = 0.0, yy = 0.0, yz = 0.0, zz = 0.0;
};

Covariance covarianceOf(const ConvexHull& hull) {
  Covariance c;
  for (const Vec3d& vertex : hull.vertices) {
    const Vec3d v = (vertex - hull.centre) / hull.radius;
    c.xx += v.x * v.x, c.xy += v.x * v.y, c.xz += v.x * v.z;
    c.yy += v.y * v.y, c.yz += v.y * v.z, c.zz += v.z * v.z;
  }
  return c;
}

double positiveRoot(double square) {
  return std::sqrt(std::max(square, kThinnest * kThinnest));
}

}  // namespace

HullEnvelope::HullEnvelope(const ConvexHull& hull, const HullBox& box) {
  if (hull.vertices.empty() || !(hull.radius > kMinRadius) || !std::isfinite(hull.radius)) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    for (std::size_t i = 0; i < kVectors; ++i) {
      set(i, {kNone, kNone, kNone});
    }
    reach_ = kNone;
    return;
  }
  set(kRoundCentre, hull.centre);
  // Only the shape counts, so it is scaled to a trace of about 1 at most.
  const Covariance sum = covarianceOf(hull);
  const double n = static_cast<double>(hull.vertices.size());
  const double lxx = positiveRoot(sum.xx / n);
  const double lyx = sum.xy / n / lxx, lzx = sum.xz / n / lxx;
  const double lyy = positiveRoot(sum.yy / n - lyx * lyx);
  const double lzy = (sum.yz / n - lyx * lzx) / lyy;
  const double lzz = positiveRoot(sum.zz / n - lzx * lzx - lzy * lzy);
  double longest = 0.0;
  for (const Vec3d& vertex : hull.vertices) {
    const Vec3d v = (vertex - hull.centre) / hull.radius;
    const double x = v.x / lxx, y = (v.y - lyx * x) / lyy, z = (v.z - lzx * x - lzy * y) / lzz;
    longest = std::max(longest, x * x + y * y + z * z);
  }
  // A sphere of radius s lies within the ellipsoid scaled by s / (smallest singular value of L), and that
  // value is at least lxx lyy lzz / |L|^2, where |L| is the norm of all entries.
  const double square = lxx * lxx + lyx * lyx + lzx * lzx + lyy * lyy + lzy * lzy + lzz * lzz;
  const double shortest = lxx * lyy * lzz / square;
  const double ball = hull.slack / hull.radius + kRounding;
  const double size = hull.radius * (std::sqrt(longest) * (1.0 + kRounding) + ball / shortest);
  set(0, Vec3d{lxx, lyx, lzx} * size);
  set(1, Vec3d{0.0, lyy, lzy} * size);
  set(2, Vec3d{0.0, 0.0, lzz} * size);
  // Also far above the rounding of the box's axes, which are orthonormal up to 1e-10.
  const double more = hull.slack + kRounding * hull.radius;
  set(kBoxCentre, box.centre);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    set(kBox + axis, box.axes[axis] * (box.half[axis] + more));
  }
  for (std::size_t i = 0; i < kVectors; ++i) {
    reach_ += l1Norm(vector(i));
  }
}

Vec3d HullEnvelope::farthest(const Vec3d& direction) const {
  const Heights at = along(direction);
  const double length = root(at);
  if (length > 0.0 && roundHeight(at) < boxHeight(at)) {
    return centre() + (vector(0) * at[0] + vector(1) * at[1] + vector(2) * at[2]) / length;
  }
  Vec3d point = vector(kBoxCentre);
  for (std::size_t i = kBox; i < kBox + 3; ++i) {
    point += vector(i) * std::copysign(1.0, at[i]);
  }
  return point;
}

}  // namespace sightline::layers
