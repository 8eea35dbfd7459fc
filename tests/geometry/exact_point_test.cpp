// Exact points and their predicates against rational numbers, mostly on ties.

#include "src/geometry/exact_point.h"
#include "tests/support/rounds.h"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace sightline::geometry {
namespace {

// Without expression templates, which take long to compile.
using Rational = boost::multiprecision::number<boost::multiprecision::cpp_rational::backend_type,
                                               boost::multiprecision::et_off>;

struct RationalVec {
  Rational x, y, z;
  explicit RationalVec(const Vec3d& v) : x(v.x), y(v.y), z(v.z) {}
  RationalVec(Rational x_, Rational y_, Rational z_) : x(std::move(x_)), y(std::move(y_)), z(std::move(z_)) {}
};

RationalVec operator+(const RationalVec& a, const RationalVec& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
RationalVec operator-(const RationalVec& a, const RationalVec& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
RationalVec operator*(const RationalVec& a, const Rational& s) {
  return {a.x * s, a.y * s, a.z * s};
}
Rational dot(const RationalVec& a, const RationalVec& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
RationalVec cross(const RationalVec& a, const RationalVec& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Rational along(const RationalVec& v, int axis) {
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

// Coordinates of several kinds: few values, single precision at several scales, and with bits far apart.
class Coordinates {
 public:
  explicit Coordinates(unsigned seed) : random_(seed) {}

  Vec3d next(int kind) { return {coordinate(kind), coordinate(kind), coordinate(kind)}; }

 private:
  double coordinate(int kind) {
    const double small = std::uniform_int_distribution<int>(-2, 2)(random_);
    const auto any = [&] {
      return double{static_cast<float>(std::uniform_real_distribution<>(-1.0, 1.0)(random_))};
    };
    switch (kind) {
      case 0:
        return small;
      case 1:
        return small / 3.0;
      case 2:
        return any();
      case 3:
        return 1e6 + any();
      case 4:
        return small + std::ldexp(any(), -90);
      default:
        return std::ldexp(any(), std::uniform_int_distribution<int>(-120, 63)(random_));
    }
  }
  std::mt19937 random_;
};
constexpr int kKinds = 6;

Vec3d oneUlp(const Vec3d& v, int which) {
  return {std::nextafter(v.x, which % 2 == 0 ? 1e30 : -1e30), v.y, v.z};
}

TEST(ExactPoint, OrientationsAreThoseOfRationalNumbers) {
  int ties = 0;
  for (int kind = 0; kind < kKinds; ++kind) {
    Coordinates coordinates(7 + kind);
    for (int i = 0; i < 400; ++i) {
      std::vector<Vec3d> p{coordinates.next(kind), coordinates.next(kind), coordinates.next(kind),
                           coordinates.next(kind)};
      if (i % 3 == 0 && kind != 4 && kind != 5) {  // close to the plane, or in it
        p[3] = p[0] + (p[1] - p[0]) * 0.5 + (p[2] - p[0]) * 0.25;
        p[3] = i % 2 == 0 ? p[3] : oneUlp(p[3], i);
      }
      if (!Lattice::allowed(p[0]) || !Lattice::allowed(p[1]) || !Lattice::allowed(p[2]) ||
          !Lattice::allowed(p[3])) {
        continue;
      }
      const Lattice lattice = Lattice::of(p);
      const RationalVec a(p[0]), b(p[1]), c(p[2]), d(p[3]);
      const RationalVec normal = cross(b - a, c - a);
      const int expected = dot(normal, d - a).sign();
      ties += expected == 0 ? 1 : 0;
      EXPECT_EQ(orientation(lattice, p[0], p[1], p[2], p[3]), expected) << "kind " << kind << " case " << i;
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(orientation(lattice, axis, p[0], p[1], p[2]), along(normal, axis).sign())
            << "kind " << kind << " case " << i;
      }
    }
  }
  EXPECT_GT(ties, 100);
}

void expectNearest(const Rational& exact, double rounded) {
  using boost::multiprecision::abs;
  const Rational off = abs(Rational(rounded) - exact);
  EXPECT_LE(off, abs(Rational(std::nextafter(rounded, 1e300)) - exact));
  EXPECT_LE(off, abs(Rational(std::nextafter(rounded, -1e300)) - exact));
}

void expectPoint(const RationalVec& exact, const ExactPoint& point) {
  for (int axis = 0; axis < 3; ++axis) {
    expectNearest(along(exact, axis), point.rounded[axis]);
  }
  const RationalVec off = RationalVec(point.rounded) - exact;
  EXPECT_LE(dot(off, off), Rational(point.error) * Rational(point.error));
  EXPECT_EQ(point.error == 0.0, dot(off, off) == 0);
}

TEST(ExactPoint, LiesBetweenTwoOthersOnlyExactly) {
  const Vec3f a(-3.0f, 1.0f, 0.5f), b(5.0f, 5.0f, -1.5f), middle(1.0f, 3.0f, -0.5f);
  EXPECT_TRUE(liesBetween(a, middle, b));
  EXPECT_TRUE(liesBetween(b, middle, a));
  EXPECT_TRUE(liesBetween(a, a, b));
  EXPECT_TRUE(liesBetween(a, b, b));
  EXPECT_FALSE(liesBetween(a, b, middle)) << "beyond the end";
  for (int axis = 0; axis < 3; ++axis) {
    Vec3f beside = middle;
    beside[axis] = std::nextafter(beside[axis], 9.0f);
    EXPECT_FALSE(liesBetween(a, beside, b)) << axis;
  }
  EXPECT_FALSE(liesBetween(a, middle, Vec3f(std::numeric_limits<float>::infinity(), 5.0f, 0.0f)));
}

TEST(ExactPoint, DefinedPointsAreRoundedOnce) {
  int points = 0;
  for (int kind = 0; kind < kKinds; ++kind) {
    Coordinates coordinates(70 + kind);
    for (int i = 0; i < test::rounds(200); ++i) {
      std::vector<Vec3d> p;
      for (int k = 0; k < 9; ++k) {
        p.push_back(coordinates.next(kind));
      }
      bool allowed = true;
      for (const Vec3d& point : p) {
        allowed = allowed && Lattice::allowed(point);
      }
      if (!allowed) {
        continue;
      }
      const Lattice lattice = Lattice::of(p);
      std::vector<RationalVec> r(p.begin(), p.end());
      expectPoint(r[0], givenPoint(lattice, p[0]));

      RationalVec normals[3] = {r[0], r[0], r[0]};
      Rational offsets[3];
      for (int k = 0; k < 3; ++k) {
        normals[k] = cross(r[3 * k + 1] - r[3 * k], r[3 * k + 2] - r[3 * k]);
        offsets[k] = dot(normals[k], r[3 * k]);
      }
      const Rational speed = dot(normals[1], r[1] - r[0]);
      if (speed != 0) {
        const Rational at = dot(normals[1], r[3] - r[0]) / speed;
        expectPoint(r[0] + (r[1] - r[0]) * at, pointOfLine(lattice, p[0], p[1], {p[3], p[4], p[5]}));
        ++points;
      }
      const Rational volume = dot(normals[0], cross(normals[1], normals[2]));
      if (volume != 0) {
        const RationalVec at =
            (cross(normals[1], normals[2]) * offsets[0] + cross(normals[2], normals[0]) * offsets[1] +
             cross(normals[0], normals[1]) * offsets[2]) *
            (1 / volume);
        const PlanePoints planes[3] = {{p[0], p[1], p[2]}, {p[3], p[4], p[5]}, {p[6], p[7], p[8]}};
        expectPoint(at, pointOfPlanes(lattice, planes));
        ++points;
      }
    }
  }
  EXPECT_GT(points, test::rounds(1000));
}

TEST(ExactPoint, ComparesAndTurnsAsRationalNumbersDo) {
  // Points where planes and lines through few given points meet: many are equal, or on a line.
  int ties = 0;
  for (int kind = 0; kind < 3; ++kind) {
    Coordinates coordinates(700 + kind);
    for (int i = 0; i < test::rounds(60); ++i) {
      std::vector<Vec3d> p;
      for (int k = 0; k < 6; ++k) {
        p.push_back(coordinates.next(kind));
      }
      const Lattice lattice = Lattice::of(p);
      std::vector<ExactPoint> points{givenPoint(lattice, p[0]), givenPoint(lattice, p[1])};
      std::vector<RationalVec> exact{RationalVec(p[0]), RationalVec(p[1])};
      const RationalVec normal =
          cross(RationalVec(p[3]) - RationalVec(p[2]), RationalVec(p[4]) - RationalVec(p[2]));
      for (const auto& [from, to] : {std::pair(0, 1), std::pair(0, 5), std::pair(1, 5)}) {
        const RationalVec a(p[from]), b(p[to]);
        const Rational speed = dot(normal, b - a);
        if (speed != 0) {
          points.push_back(pointOfLine(lattice, p[from], p[to], {p[2], p[3], p[4]}));
          exact.push_back(a + (b - a) * (dot(normal, RationalVec(p[2]) - a) / speed));
        }
      }
      for (std::size_t a = 0; a < points.size(); ++a) {
        for (std::size_t b = 0; b < points.size(); ++b) {
          for (int axis = 0; axis < 3; ++axis) {
            const Rational difference = along(exact[a], axis) - along(exact[b], axis);
            EXPECT_EQ(compareAlong(axis, points[a], points[b]), difference.sign());
            for (std::size_t c = 0; c < points.size(); ++c) {
              const int turn = along(cross(exact[b] - exact[a], exact[c] - exact[a]), axis).sign();
              ties += turn == 0 && a != b && b != c && c != a ? 1 : 0;
              EXPECT_EQ(orientation(axis, points[a], points[b], points[c]), turn);
            }
          }
        }
      }
    }
  }
  EXPECT_GT(ties, test::rounds(1000));
}

TEST(ExactPoint, CoordinatesOutOfReachAreToldApart) {
  EXPECT_TRUE(Lattice::allowed(0.0));
  EXPECT_TRUE(Lattice::allowed(-0x1p-149));
  EXPECT_TRUE(Lattice::allowed(0x1.fffffffffffffp63));
  EXPECT_FALSE(Lattice::allowed(0x1p64));
  EXPECT_FALSE(Lattice::allowed(0x1p-150));
  EXPECT_FALSE(Lattice::allowed(1.0 + 0.0 + 1e-300 - 1.0 + 3e-300));
}

// The largest numbers that predicates have to hold: coordinates with bits at both ends.
TEST(ExactPoint, HoldsTheLongestCoordinates) {
  const double large = 0x1.fffffffffffffp63, tiny = 0x1p-149;
  const std::vector<Vec3d> p{{large, -large, tiny}, {-large, large, large}, {tiny, large, -large},
                             {large, tiny, large},  {-large, tiny, -large}, {tiny, -large, large},
                             {large, large, -tiny}, {-large, -large, tiny}, {tiny, tiny, large}};
  const Lattice lattice = Lattice::of(p);
  const PlanePoints planes[3] = {{p[0], p[1], p[2]}, {p[3], p[4], p[5]}, {p[6], p[7], p[8]}};
  const ExactPoint middle = pointOfPlanes(lattice, planes);
  const ExactPoint line = pointOfLine(lattice, p[0], p[4], planes[2]);
  EXPECT_TRUE(isFinite(middle.rounded));
  for (int axis = 0; axis < 3; ++axis) {
    const int turn = orientation(axis, middle, line, givenPoint(lattice, p[1]));
    EXPECT_EQ(orientation(axis, line, middle, givenPoint(lattice, p[1])), -turn);
    EXPECT_EQ(orientation(axis, middle, middle, line), 0);
  }
}

}  // namespace
}  // namespace sightline::geometry
