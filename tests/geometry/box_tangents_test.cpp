#include "src/geometry/box_tangents.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <ostream>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "tests/support/rounds.h"

namespace sightline::geometry {
namespace {

// The judge works on whole numbers of up to 40 bits, whose determinants are exact in 128 bits.
__extension__ using Exact = __int128;
using Vec3i = Vec3<Exact>;

struct Case {
  Vec3d low, high, direction;

  Vec3d corner(unsigned i) const { return cornerOf(low, high, static_cast<BoxCorner>(i)); }
};

std::ostream& operator<<(std::ostream& out, const Case& c) {
  const auto put = [&](const Vec3d& v) { out << "(" << v.x << ", " << v.y << ", " << v.z << ") "; };
  out.precision(17);
  out << "box ", put(c.low), put(c.high);
  out << "direction ", put(c.direction);
  return out;
}

Exact determinant(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return dot(cross(Vec3i(a), Vec3i(b)), Vec3i(c));
}

int signOf(Exact value) {
  return (value > 0 ? 1 : 0) - (value < 0 ? 1 : 0);
}

// Clips the line with the three slabs, in exact fractions.
bool lineMeetsBox(const Case& c) {
  struct Fraction {
    Exact over, under;  // under > 0
  };
  std::vector<Fraction> enter, leave;
  for (int axis = 0; axis < 3; ++axis) {
    Exact low = static_cast<Exact>(c.low[axis]), high = static_cast<Exact>(c.high[axis]);
    Exact d = static_cast<Exact>(c.direction[axis]);
    if (d == 0) {
      if (low > 0 || high < 0) {
        return false;
      }
      continue;
    }
    if (d < 0) {
      d = -d;
      low = -std::exchange(high, -low);
    }
    enter.push_back({low, d});
    leave.push_back({high, d});
  }
  for (const Fraction& in : enter) {
    for (const Fraction& out : leave) {
      if (in.over * out.under > out.over * in.under) {
        return false;
      }
    }
  }
  return true;
}

// The definition, against all eight corners. A tangent vertex on the line would not make a plane.
bool holds(const Case& c, const BoxTangents& tangents) {
  const Vec3d low = c.corner(tangents.low), high = c.corner(tangents.high);
  bool good =
      cross(Vec3i(c.direction), Vec3i(low)) != Vec3i() && cross(Vec3i(c.direction), Vec3i(high)) != Vec3i();
  for (unsigned i = 0; i < 8; ++i) {
    good = good && determinant(c.direction, low, c.corner(i)) >= 0 &&
           determinant(c.direction, high, c.corner(i)) <= 0;
  }
  return good;
}

struct Method {
  const char* name;
  BoxTangents (*find)(const Vec3d&, const Vec3d&, const Vec3d&);
};
constexpr Method kTables{"tables", tangentsByTables};
constexpr Method kAllVertices{"all vertices", tangentsOfAllVertices};

// True when the line misses the box.
bool check(const Method& method, const Case& c) {
  const bool misses = !lineMeetsBox(c);
  const BoxTangents tangents = method.find(c.low, c.high, c.direction);
  EXPECT_EQ(tangents.exist, misses) << method.name << ": " << c;
  if (tangents.exist) {
    EXPECT_TRUE(holds(c, tangents)) << method.name << ": low " << int{tangents.low} << " high "
                                    << int{tangents.high} << ", " << c;
  }
  return misses;
}

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double whole(int low, int high) {
    return static_cast<double>(low + static_cast<int>(engine_() % static_cast<unsigned>(high - low + 1)));
  }
  // Returns a whole number of up to `bits` bits, with either sign.
  double wide(int bits) {
    const double size = static_cast<double>(engine_() >> (64 - bits));
    return oneIn(2) ? size : -size;
  }
  double in(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  bool oneIn(unsigned n) { return engine_() % n == 0; }

 private:
  std::mt19937_64 engine_;
};

// A box strictly in the region, of whole coordinates.
Case boxIn(Random& random, int region) {
  Case c;
  for (int axis = 0, rest = region; axis < 3; ++axis, rest /= 3) {
    const double near = random.whole(1, 6), far = near + random.whole(1, 6);
    c.low[axis] = rest % 3 == 1 ? near : rest % 3 == 2 ? -far : -near;
    c.high[axis] = rest % 3 == 1 ? far : rest % 3 == 2 ? -near : random.whole(1, 6);
  }
  return c;
}

using DirectedEdge = std::pair<int, int>;

// All pairs of corners with the box on the positive side of their plane through the origin: the edges of the
// box's projection, when the origin is in no face's plane.
std::set<DirectedEdge> silhouetteByBruteForce(const Case& c) {
  std::set<DirectedEdge> edges;
  for (unsigned from = 0; from < 8; ++from) {
    for (unsigned to = 0; to < 8; ++to) {
      bool outer = cross(Vec3i(c.corner(from)), Vec3i(c.corner(to))) != Vec3i();
      for (unsigned x = 0; x < 8; ++x) {
        outer = outer && determinant(c.corner(from), c.corner(to), c.corner(x)) >= 0;
      }
      if (outer) {
        edges.insert({from, to});
      }
    }
  }
  return edges;
}

std::set<DirectedEdge> edgesOf(const Silhouette& loop) {
  std::set<DirectedEdge> edges;
  for (std::size_t i = 0; i < static_cast<std::size_t>(loop.count); ++i) {
    edges.insert({loop.corners[i], loop.corners[(i + 1) % static_cast<std::size_t>(loop.count)]});
  }
  return edges;
}

TEST(BoxTangents, ARegionSaysOnWhichSideOfEachSlabTheOriginIs) {
  EXPECT_EQ(regionOfOrigin({-1, -1, -1}, {1, 1, 1}), 0);
  EXPECT_EQ(regionOfOrigin({1, -1, -1}, {2, 1, 1}), 1);
  EXPECT_EQ(regionOfOrigin({-2, -1, -1}, {-1, 1, 1}), 2);
  EXPECT_EQ(regionOfOrigin({-1, 1, -2}, {1, 2, -1}), 3 + 18);
  EXPECT_EQ(regionOfOrigin({0, -1, -1}, {2, 1, 0}), 0) << "on the planes of two slabs";
  EXPECT_EQ(regionOfOrigin({0, 0, 0}, {0, 0, 0}), 0) << "a point";
  EXPECT_EQ(regionOfOrigin({0, 3, 0}, {0, 3, 0}), 3) << "a point beside the origin";
}

TEST(BoxTangents, EveryRowOfTheFirstTableIsTheSilhouetteByBruteForce) {
  EXPECT_EQ(silhouetteFrom(0).count, 0);
  Random random(1);
  for (int region = 1; region < kRegions; ++region) {
    const Silhouette& loop = silhouetteFrom(region);
    const int faces = (region % 3 != 0) + (region / 3 % 3 != 0) + (region / 9 != 0);
    EXPECT_EQ(loop.count, faces == 1 ? 4 : 6) << "region " << region;
    for (int sample = 0; sample < 50; ++sample) {
      const Case c = boxIn(random, region);
      ASSERT_EQ(regionOfOrigin(c.low, c.high), region) << c;
      EXPECT_EQ(edgesOf(loop), silhouetteByBruteForce(c)) << "region " << region << ", " << c;
    }
  }
}

// Bit i: edge i is positive; nothing where an edge is neither. Four edges: the last one three times.
int patternOf(const Case& c, const Silhouette& loop) {
  int pattern = 0;
  for (int i = 0; i < 6; ++i) {
    const int from = std::min(i, loop.count - 1), to = (from + 1) % loop.count;
    const int sign = signOf(determinant(c.direction, c.corner(loop.corners[static_cast<std::size_t>(from)]),
                                        c.corner(loop.corners[static_cast<std::size_t>(to)])));
    if (sign == 0) {
      return -1;
    }
    pattern |= sign > 0 ? 1 << i : 0;
  }
  return pattern;
}

// All directions of small whole numbers hit every row that the table has for a region, and no other.
TEST(BoxTangents, EveryRowOfTheSecondTableNamesTheTangentsByBruteForce) {
  std::set<int> rows;
  for (int positive = 0; positive < 64; ++positive) {
    if (tangentPositions(static_cast<unsigned>(positive)).exist) {
      rows.insert(positive);
    }
  }
  EXPECT_EQ(rows.size(), 30u) << "runs of 1 to 5 edges that begin at any of 6";
  Random random(2);
  for (int region = 1; region < kRegions; ++region) {
    const Silhouette& loop = silhouetteFrom(region);
    std::set<int> hit;
    for (int sample = 0; sample < 8; ++sample) {
      Case c = boxIn(random, region);
      for (int i = 0; i < 15 * 15 * 15; ++i) {
        c.direction = Vec3d(i % 15 - 7, i / 15 % 15 - 7, i / 225 - 7);
        const int pattern = patternOf(c, loop);
        if (pattern <= 0 || pattern == 63) {
          EXPECT_TRUE(pattern < 0 || lineMeetsBox(c)) << c;
          continue;
        }
        hit.insert(pattern);
        const TangentPositions& at = tangentPositions(static_cast<unsigned>(pattern));
        ASSERT_TRUE(at.exist) << "region " << region << " row " << pattern << ", " << c;
        ASSERT_LT(std::max(at.low, at.high), loop.count) << "region " << region << " row " << pattern;
        ASSERT_TRUE(holds(c, {loop.corners[at.low], loop.corners[at.high], true}))
            << "region " << region << " row " << pattern << ", " << c;
      }
    }
    if (loop.count == 6) {
      EXPECT_EQ(hit, rows) << "region " << region;
    } else {
      EXPECT_EQ(hit.size(), 12u) << "region " << region << ": runs of 1 to 3 edges that begin at any of 4";
    }
  }
}

// Flat boxes, segments and points, origins on planes, edges and corners, directions along axes and diagonals,
// lines through edges and corners: all that there are of coordinates from -2 to 2.
TEST(BoxTangents, EveryBoxAndEveryLineOfSmallWholeNumbersIsRight) {
  std::vector<std::pair<double, double>> ranges;
  for (int low = -2; low <= 2; ++low) {
    for (int high = low; high <= 2; ++high) {
      ranges.emplace_back(low, high);
    }
  }
  int misses = 0, meets = 0;
  for (const auto& x : ranges) {
    for (const auto& y : ranges) {
      for (const auto& z : ranges) {
        Case c{{x.first, y.first, z.first}, {x.second, y.second, z.second}, {}};
        for (int i = 0; i < 125; ++i) {
          c.direction = Vec3d(i % 5 - 2, i / 5 % 5 - 2, i / 25 - 2);
          if (c.direction == Vec3d()) {
            continue;
          }
          const bool missed = check(kTables, c);
          check(kAllVertices, c);
          missed ? ++misses : ++meets;
        }
        ASSERT_FALSE(HasFailure()) << c;
      }
    }
  }
  EXPECT_GT(misses, 100000);
  EXPECT_GT(meets, 100000);
}

// A line that goes through a corner, an edge, a face or the inside of the box, or a step beside that.
Vec3d directionAtBox(Random& random, const Case& c) {
  Vec3d target;
  for (int axis = 0; axis < 3; ++axis) {
    const double share = random.whole(-1, 5);
    target[axis] = c.low[axis] * 4.0 + (c.high[axis] - c.low[axis]) * std::clamp(share, 0.0, 4.0);
  }
  const Vec3d step(random.whole(-1, 1), random.whole(-1, 1), random.whole(-1, 1));
  const Vec3d direction = random.oneIn(2) ? target : target + step;
  return random.oneIn(2) ? direction : -direction;
}

TEST(BoxTangents, RandomBoxesAndLinesThatTouchThemAreRight) {
  int misses = 0, meets = 0;
  for (std::uint64_t seed = 1; seed <= test::rounds(100000u) && !HasFailure(); ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const int size = random.oneIn(2) ? 10 : 1000;
    Case c;
    for (int axis = 0; axis < 3; ++axis) {
      c.low[axis] = random.whole(-size, size);
      c.high[axis] = random.oneIn(5) ? c.low[axis] : c.low[axis] + random.whole(0, size);
    }
    c.direction = random.oneIn(2) ? directionAtBox(random, c)
                                  : Vec3d(random.whole(-size, size), random.whole(-size, size),
                                          random.whole(-size, size));
    if (c.direction == Vec3d()) {
      continue;
    }
    const bool missed = check(kTables, c);
    check(kAllVertices, c);
    missed ? ++misses : ++meets;
  }
  EXPECT_GT(misses, test::rounds(20000));
  EXPECT_GT(meets, test::rounds(20000));
}

// Two vectors of the plane, of about 38 bits, whose determinant is 1: adding a multiple of one to the other
// keeps it.
std::array<std::array<double, 2>, 2> nearlyParallel(Random& random) {
  std::array<std::array<double, 2>, 2> v{{{1, 0}, {0, 1}}};
  for (std::size_t i = 0; v[i][0] + v[i][1] < 0x1p36; i = 1 - i) {
    const double factor = random.whole(1, 4);
    v[i] = {v[i][0] + factor * v[1 - i][0], v[i][1] + factor * v[1 - i][1]};
  }
  return v;
}

// Products of numbers of 38 bits are rounded; lines that pass an edge by a hair make them equal although the
// exact ones are not.
TEST(BoxTangents, AreExactWhereRoundedProductsAreEqual) {
  int ties = 0, misses = 0, meets = 0;
  for (std::uint64_t seed = 1; seed <= 100000 && !HasFailure(); ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const auto [along, edge] = nearlyParallel(random);
    // The line runs by an edge along z, later turned to x, y or z.
    const Vec3d direction(along[0], along[1], random.wide(34)), corner(edge[0], edge[1], random.wide(34));
    const int turn = static_cast<int>(random.whole(0, 2));
    const double mirror = random.oneIn(2) ? 1.0 : -1.0;
    Case c;
    for (int from = 0; from < 3; ++from) {
      const int axis = (from + turn) % 3;
      const double a = corner[from] * mirror,
                   b = a + (random.oneIn(2) ? random.wide(36) : random.whole(-3, 3));
      c.low[axis] = std::min(a, b), c.high[axis] = std::max(a, b);
      c.direction[axis] = direction[from];
    }
    for (unsigned i = 0; i < 8; ++i) {
      const Vec3d rounded = cross(c.direction, c.corner(i));
      const Vec3i exact = cross(Vec3i(c.direction), Vec3i(c.corner(i)));
      for (int axis = 0; axis < 3; ++axis) {
        ties += rounded[axis] == 0.0 && exact[axis] != 0 ? 1 : 0;
      }
    }
    const bool missed = check(kTables, c);
    missed ? ++misses : ++meets;
  }
  EXPECT_GT(ties, 100000);
  EXPECT_GT(misses, 10000);
  EXPECT_GT(meets, 10000);
}

TEST(BoxTangents, HoldWithinRoundingForRandomDoubles) {
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 100000 && !HasFailure(); ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    Case c;
    for (int axis = 0; axis < 3; ++axis) {
      const double a = random.in(-5, 5), b = random.in(-5, 5);
      c.low[axis] = std::min(a, b), c.high[axis] = std::max(a, b);
      c.direction[axis] = random.in(-1e3, 1e3);
    }
    for (const Method& method : {kTables, kAllVertices}) {
      const BoxTangents tangents = method.find(c.low, c.high, c.direction);
      found += tangents.exist ? 1 : 0;
      for (unsigned i = 0; i < 8 && tangents.exist; ++i) {
        const Vec3d x = c.corner(i), low = c.corner(tangents.low), high = c.corner(tangents.high);
        const double size = 0x1p-50 * length(c.direction) * length(x);
        EXPECT_GE(dot(cross(c.direction, low), x), -size * length(low)) << method.name << ": " << c;
        EXPECT_LE(dot(cross(c.direction, high), x), size * length(high)) << method.name << ": " << c;
      }
    }
  }
  EXPECT_GT(found, 100000);
}

TEST(BoxTangents, AnOppositeDirectionExchangesThePlanes) {
  const Vec3d low(1, 2, 3), high(4, 4, 5), direction(1, -1, 0.5);
  for (const Method& method : {kTables, kAllVertices}) {
    const BoxTangents forth = method.find(low, high, direction), back = method.find(low, high, -direction);
    ASSERT_TRUE(forth.exist && back.exist) << method.name;
    EXPECT_EQ(forth.low, back.high) << method.name;
    EXPECT_EQ(forth.high, back.low) << method.name;
  }
}

}  // namespace
}  // namespace sightline::geometry
