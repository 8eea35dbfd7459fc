// Orientations with a floating-point filter.
//
// Based on: J. R. Shewchuk. Adaptive precision floating-point arithmetic and fast robust geometric
// predicates. Discrete and Computational Geometry 18, 1997: the filters of orientation() of given points,
// with his bounds. Points that lines and planes define: M. Attene. Indirect predicates for geometric
// constructions. Computer-Aided Design 126, 2020. Differs from both: what the filter leaves open is computed
// in whole numbers instead of expansions, and a defined point is computed once, so that its filter starts
// from coordinates that are rounded once.

#include "src/geometry/exact_point.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace sightline::geometry {
namespace {

__extension__ using Wide = __int128;

constexpr double kUnit = 0x1p-53;
// Shewchuk's bounds, (3 + 16 u) u and (7 + 56 u) u, rounded up.
constexpr double kPlaneBound = 3.0000000000000009 * kUnit, kSpaceBound = 7.0000000000000018 * kUnit;

int signOf(double value) {
  return value > 0.0 ? 1 : value < 0.0 ? -1 : 0;
}
int signOf(Wide value) {
  return value > 0 ? 1 : value < 0 ? -1 : 0;
}

// Differences of coordinates in units of the lattice, if all of them are less than 2^limit: then a difference
// is a number of at most 53 bits, so double precision has it exactly.
struct Units {
  Units(const Lattice& lattice, int limit)
      : scale(lattice.units()), most(static_cast<double>(std::int64_t{1} << limit)) {}
  std::int64_t of(double difference) {
    const double units = difference * scale;
    fits = fits && std::abs(units) < most;
    return fits ? static_cast<std::int64_t>(units) : 0;
  }
  double scale, most;
  bool fits = true;
};

// 2^exponent times the whole numbers' quotient, in each coordinate.
void round(const Lattice& lattice, ExactPoint& point) {
  Vec3d error;
  for (int axis = 0; axis < 3; ++axis) {
    const RoundedQuotient quotient =
        roundQuotient(point.numerator[axis], point.denominator, lattice.exponent());
    point.rounded[axis] = quotient.value;
    error[axis] = quotient.error;
  }
  // Two units in the last place cover the rounding of the sum and of the root; squares may underflow.
  point.error = error == Vec3d{} ? 0.0 : maxComponent(error) * 1.7320508075688776;
}

ExactPoint makePoint(const Lattice& lattice, const WholeVec<7>& numerator, const Whole<6>& denominator) {
  ExactPoint point;
  if (denominator.sign() < 0) {
    point.numerator = {-numerator.x, -numerator.y, -numerator.z};
    point.denominator = -denominator;
  } else {
    point.numerator = numerator;
    point.denominator = denominator;
  }
  round(lattice, point);
  return point;
}

template <int kDegree>
WholeVec<7> widened(const WholeVec<kDegree>& v) {
  return {v.x, v.y, v.z};
}

WholeVec<2> normalOf(const Lattice& lattice, const PlanePoints& plane) {
  const WholeVec<1> a = lattice.whole(plane.a);
  return cross(lattice.whole(plane.b) - a, lattice.whole(plane.c) - a);
}

}  // namespace

int orientation(const Lattice& lattice, const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  const Vec3d p = a - d, q = b - d, r = c - d;
  const double qx_ry = q.x * r.y, rx_qy = r.x * q.y, rx_py = r.x * p.y, px_ry = p.x * r.y;
  const double px_qy = p.x * q.y, qx_py = q.x * p.y;
  // Shewchuk's sign is that of d below the plane, so it is turned around.
  const double determinant = -(p.z * (qx_ry - rx_qy) + q.z * (rx_py - px_ry) + r.z * (px_qy - qx_py));
  const double magnitude = (std::abs(qx_ry) + std::abs(rx_qy)) * std::abs(p.z) +
                           (std::abs(rx_py) + std::abs(px_ry)) * std::abs(q.z) +
                           (std::abs(px_qy) + std::abs(qx_py)) * std::abs(r.z);
  const double bound = kSpaceBound * magnitude;
  if (determinant > bound || -determinant > bound || magnitude == 0.0) {
    return signOf(determinant);
  }
  Units units(lattice, 40);
  const std::int64_t px = units.of(p.x), py = units.of(p.y), pz = units.of(p.z), qx = units.of(q.x),
                     qy = units.of(q.y), qz = units.of(q.z), rx = units.of(r.x), ry = units.of(r.y),
                     rz = units.of(r.z);
  if (units.fits) {  // a term has 120 bits
    return -signOf((Wide{qx} * ry - Wide{rx} * qy) * pz + (Wide{rx} * py - Wide{px} * ry) * qz +
                   (Wide{px} * qy - Wide{qx} * py) * rz);
  }
  const WholeVec<1> origin = lattice.whole(d);
  const WholeVec<1> u = lattice.whole(a) - origin, v = lattice.whole(b) - origin,
                    w = lattice.whole(c) - origin;
  return -dot(cross(u, v), w).sign();
}

int orientation(const Lattice& lattice, int axis, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const double au = a[u] - c[u], av = a[v] - c[v], bu = b[u] - c[u], bv = b[v] - c[v];
  const double left = au * bv, right = av * bu;
  const double determinant = left - right, magnitude = std::abs(left) + std::abs(right);
  const double bound = kPlaneBound * magnitude;
  if (determinant > bound || -determinant > bound || magnitude == 0.0) {
    return signOf(determinant);
  }
  Units units(lattice, 53);
  const std::int64_t pu = units.of(au), pv = units.of(av), qu = units.of(bu), qv = units.of(bv);
  if (units.fits) {
    return signOf(Wide{pu} * qv - Wide{pv} * qu);
  }
  const Whole<1> cu = lattice.whole(c[u]), cv = lattice.whole(c[v]);
  return ((lattice.whole(a[u]) - cu) * (lattice.whole(b[v]) - cv) -
          (lattice.whole(a[v]) - cv) * (lattice.whole(b[u]) - cu))
      .sign();
}

bool areOnOneLine(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  const std::array points{Vec3d(a), Vec3d(b), Vec3d(c)};
  const Vec3d to_b = points[1] - points[0], to_c = points[2] - points[0];
  // Most points are told apart by far more than rounding, which is below 1e-15 here.
  if (length(cross(to_b, to_c)) > 1e-12 * length(to_b) * length(to_c) ||
      !std::all_of(points.begin(), points.end(), [](const Vec3d& at) { return Lattice::allowed(at); })) {
    return false;
  }
  const Lattice lattice = Lattice::of(points);
  return orientation(lattice, 0, points[0], points[1], points[2]) == 0 &&
         orientation(lattice, 1, points[0], points[1], points[2]) == 0 &&
         orientation(lattice, 2, points[0], points[1], points[2]) == 0;
}

bool liesBetween(const Vec3f& a, const Vec3f& p, const Vec3f& b) {
  for (int axis = 0; axis < 3; ++axis) {
    if (p[axis] < std::min(a[axis], b[axis]) || p[axis] > std::max(a[axis], b[axis])) {
      return false;
    }
  }
  return areOnOneLine(a, p, b);
}

int longestAxis(const Lattice& lattice, const PlanePoints& triangle) {
  const WholeVec<2> normal = normalOf(lattice, triangle);
  int longest = -1;
  for (int axis = 0; axis < 3; ++axis) {
    if (normal[axis].sign() != 0 &&
        (longest < 0 || Words::compare(normal[axis].words(), normal[axis].wordCount(),
                                       normal[longest].words(), normal[longest].wordCount()) > 0)) {
      longest = axis;
    }
  }
  return longest;
}

ExactPoint givenPoint(const Lattice& lattice, const Vec3d& point) {
  ExactPoint given;
  given.numerator = widened(lattice.whole(point));
  given.denominator = Whole<6>(1);
  given.rounded = point + Vec3d{};  // 0 instead of -0
  return given;
}

ExactPoint pointOfLine(const Lattice& lattice, const Vec3d& p, const Vec3d& q, const PlanePoints& plane) {
  const WholeVec<2> normal = normalOf(lattice, plane);
  const WholeVec<1> from = lattice.whole(p), along = lattice.whole(q) - from;
  const Whole<3> whole = dot(normal, along), part = dot(normal, lattice.whole(plane.a) - from);
  return makePoint(lattice, widened(from * whole + along * part), whole);
}

ExactPoint pointOfLines(const Lattice& lattice, int axis, const Vec3d& p, const Vec3d& q, const Vec3d& r,
                        const Vec3d& s) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const WholeVec<1> from = lattice.whole(p), along = lattice.whole(q) - from;
  const WholeVec<1> other = lattice.whole(r), across = lattice.whole(s) - other, between = other - from;
  const Whole<2> whole = along[u] * across[v] - along[v] * across[u];
  const Whole<2> part = between[u] * across[v] - between[v] * across[u];
  return makePoint(lattice, widened(from * whole + along * part), whole);
}

ExactPoint pointOfPlanes(const Lattice& lattice, std::span<const PlanePoints, 3> planes) {
  const WholeVec<2> n[3] = {normalOf(lattice, planes[0]), normalOf(lattice, planes[1]),
                            normalOf(lattice, planes[2])};
  const Whole<3> offset[3] = {dot(n[0], lattice.whole(planes[0].a)), dot(n[1], lattice.whole(planes[1].a)),
                              dot(n[2], lattice.whole(planes[2].a))};
  const WholeVec<4> c12 = cross(n[1], n[2]), c20 = cross(n[2], n[0]), c01 = cross(n[0], n[1]);
  return makePoint(lattice, c12 * offset[0] + c20 * offset[1] + c01 * offset[2], dot(n[0], c12));
}

// The filter. The rounded coordinates are off by at most u times themselves, so with d the greatest of the
// differences along a coordinate and m the greatest coordinate, a computed difference is off by at most
// e = u (2 m + d) (1 + 2 u). The determinant, a difference of two products of such differences, is then off
// by at most 2 (du ev + dv eu) + 2 eu ev, and by 3 u 2 du dv (1 + u) for its own rounding. e exceeds u d, so
// the factor 8 in place of 2 covers all of it, also that the bound itself is rounded. The
// 2^-1000 covers underflow: a rounded coordinate below the normal range is off by up to 2^-1075 more, times a
// difference below 2^65, and products round by as little.
int orientation(int axis, const ExactPoint& a, const ExactPoint& b, const ExactPoint& c) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const double au = a.rounded[u] - c.rounded[u], av = a.rounded[v] - c.rounded[v];
  const double bu = b.rounded[u] - c.rounded[u], bv = b.rounded[v] - c.rounded[v];
  const double du = std::max(std::abs(au), std::abs(bu)), dv = std::max(std::abs(av), std::abs(bv));
  const double mu = std::max({std::abs(a.rounded[u]), std::abs(b.rounded[u]), std::abs(c.rounded[u])});
  const double mv = std::max({std::abs(a.rounded[v]), std::abs(b.rounded[v]), std::abs(c.rounded[v])});
  const double eu = kUnit * (2.0 * mu + du), ev = kUnit * (2.0 * mv + dv);
  const double determinant = au * bv - av * bu;
  const double bound = 8.0 * (du * ev + dv * eu + eu * ev) + 0x1p-1000;
  if (determinant > bound || -determinant > bound) {
    return signOf(determinant);
  }
  const WholeVec<7>&p = a.numerator, &q = b.numerator, &r = c.numerator;
  const Whole<14> pq = p[u] * q[v] - p[v] * q[u], qr = q[u] * r[v] - q[v] * r[u],
                  rp = r[u] * p[v] - r[v] * p[u];
  return (pq * c.denominator + qr * a.denominator + rp * b.denominator).sign();
}

int compareAlong(int axis, const ExactPoint& a, const ExactPoint& b) {
  // Rounding is monotonic, so rounded coordinates that differ are in the right order.
  if (a.rounded[axis] != b.rounded[axis]) {
    return a.rounded[axis] < b.rounded[axis] ? -1 : 1;
  }
  if (a.error == 0.0 && b.error == 0.0) {
    return 0;
  }
  return compare(a.numerator[axis] * b.denominator, b.numerator[axis] * a.denominator);
}

}  // namespace sightline::geometry
