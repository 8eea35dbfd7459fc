// Checks hidden lines of small scenes of integers in integer arithmetic. Every kind of tie occurs.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <vector>

#include "sightline/drawing/hidden_lines.h"
#include "tests/drawing/sketch.h"

namespace sightline {
namespace {

using test::flatView;
using test::Sketch;
using test::squareView;

using Int = std::int64_t;
struct IntPoint {
  Int x = 0, y = 0, z = 0;
};
IntPoint operator-(const IntPoint& a, const IntPoint& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
IntPoint cross(const IntPoint& a, const IntPoint& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Int dot(const IntPoint& a, const IntPoint& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

struct IntTriangle {
  IntPoint corner[3];
  bool single_sided = false;
};

// Shares of lines are k / kUnit. Points times kUnit are whole; products stay below 2^63.
constexpr Int kUnit = 840 * 16;

class IntWorld {
 public:
  IntWorld(std::uint32_t seed, bool orthographic) : random_(seed), orthographic_(orthographic) {
    for (int i = 0; i < 9; ++i) {
      IntTriangle triangle{{point(), point(), point()}, below(3) == 0};
      if (!triangles_.empty() && below(2) == 0) {  // an edge in common
        const IntTriangle& other =
            triangles_[static_cast<std::size_t>(below(static_cast<int>(triangles_.size())))];
        triangle.corner[0] = other.corner[1];
        triangle.corner[1] = other.corner[0];
      }
      triangles_.push_back(triangle);
      sketch_.add({{place(triangle.corner[0]), place(triangle.corner[1]), place(triangle.corner[2])}},
                  triangle.single_sided ? 1 : 0);
    }
    for (int i = 0; i < 12; ++i) {
      lines_.push_back({point(), point()});
    }
    for (const IntTriangle& t : triangles_) {
      lines_.push_back({t.corner[0], t.corner[1]});
      lines_.push_back({t.corner[1], t.corner[2]});
    }
  }

  void check() {
    const View view = orthographic_ ? flatView(8) : squareView();
    for (const auto& [a, b] : lines_) {
      const std::vector<LinePiece> pieces = sketch_.pieces(view, sketch_.line(place(a), place(b)));
      const IntPoint ab = b - a;
      const bool end_on = orthographic_ ? ab.x == 0 && ab.y == 0 : zero(cross(a, b));
      EXPECT_TRUE(pieces.empty() || !end_on);
      for (Int k = 16 * 7; k < kUnit && !end_on; k += 16 * 7) {
        const double share = static_cast<double>(k) / static_cast<double>(kUnit);
        const bool drawn = std::any_of(pieces.begin(), pieces.end(), [&](const LinePiece& p) {
          return p.from_share <= share && share <= p.to_share;
        });
        // A state that holds at a single point only, where a line touches an edge, makes no piece.
        const bool wrong =
            visible(a, b, k) != drawn && visible(a, b, k - 1) != drawn && visible(a, b, k + 1) != drawn;
        EXPECT_FALSE(wrong) << "share " << share << (drawn ? " is drawn" : " is not drawn") << ": (" << a.x
                            << ' ' << a.y << ' ' << a.z << ") (" << b.x << ' ' << b.y << ' ' << b.z << ")";
        (drawn ? drawn_ : hidden_) += 1;
      }
    }
  }
  int drawn() const { return drawn_; }
  int hidden() const { return hidden_; }

 private:
  static bool zero(const IntPoint& p) { return p.x == 0 && p.y == 0 && p.z == 0; }
  static Vec3f place(const IntPoint& p) {
    return {static_cast<float>(p.x), static_cast<float>(p.y), -static_cast<float>(p.z)};
  }
  int below(int n) { return static_cast<int>(random_() % static_cast<unsigned>(n)); }
  // z is the depth here, so triangles are seen clockwise from their front. Some lie behind the eye.
  IntPoint point() { return {below(9) - 4, below(9) - 4, below(8) == 0 ? -below(3) : 1 + below(6)}; }

  bool visible(const IntPoint& a, const IntPoint& b, Int k) const {
    const IntPoint x{a.x * (kUnit - k) + b.x * k, a.y * (kUnit - k) + b.y * k, a.z * (kUnit - k) + b.z * k};
    const Int border = orthographic_ ? 4 * kUnit : x.z;
    if (x.z < kUnit || std::abs(x.x) > border || std::abs(x.y) > border) {
      return false;
    }
    return std::none_of(triangles_.begin(), triangles_.end(),
                        [&](const IntTriangle& t) { return hides(t, x); });
  }

  // Whether the ray from the eye to x / kUnit intersects the closed triangle before that point, at a depth of
  // at least 1.
  bool hides(const IntTriangle& t, const IntPoint& x) const {
    const IntPoint normal = cross(t.corner[1] - t.corner[0], t.corner[2] - t.corner[0]);
    const IntPoint sight = orthographic_ ? IntPoint{0, 0, kUnit} : x;
    const IntPoint start = orthographic_ ? IntPoint{x.x, x.y, 0} : IntPoint{};
    const Int height = dot(normal, t.corner[0]) * kUnit - dot(normal, start);  // of the plane over the start
    const Int slope = dot(normal, sight);
    const Int facing = orthographic_ ? normal.z : dot(normal, t.corner[0]);
    // In these mirrored coordinates a normal that points away from the eye is that of a front.
    if (slope == 0 || facing == 0 || (t.single_sided && facing < 0)) {
      return false;
    }
    // The ray intersects the plane at start + (height / slope) sight, which must be before x and at depth 1
    // or more.
    const Int sign = slope > 0 ? 1 : -1;
    const Int end = orthographic_ ? x.z : kUnit;  // x = start + (end / kUnit) sight
    if (sign * height * kUnit >= sign * slope * end || sign * height <= 0 ||
        sign * height * sight.z < sign * slope * kUnit) {
      return false;
    }
    bool left = false;
    bool right = false;
    for (int i = 0; i < 3; ++i) {
      const IntPoint& p = t.corner[i];
      const IntPoint& q = t.corner[(i + 1) % 3];
      const Int side = orthographic_ ? (q.x - p.x) * (x.y - p.y * kUnit) - (q.y - p.y) * (x.x - p.x * kUnit)
                                     : dot(cross(p, q), x);
      left = left || side > 0;
      right = right || side < 0;
    }
    // In perspective the three planes also bound the pyramid behind the eye, which the depth rules out.
    return !(left && right);
  }

  std::mt19937 random_;
  bool orthographic_ = false;
  Sketch sketch_;
  std::vector<IntTriangle> triangles_;
  std::vector<std::array<IntPoint, 2>> lines_;
  int drawn_ = 0, hidden_ = 0;
};

TEST(HiddenLines, AgreeWithExactArithmeticOnWholeNumbers) {
  for (const bool orthographic : {false, true}) {
    int drawn = 0;
    int hidden = 0;
    for (std::uint32_t seed = 1; seed <= 150 && !HasFailure(); ++seed) {
      SCOPED_TRACE(::testing::Message() << "seed " << seed << (orthographic ? ", orthographic" : ""));
      IntWorld world(seed, orthographic);
      world.check();
      drawn += world.drawn();
      hidden += world.hidden();
    }
    EXPECT_GT(drawn, 10000);
    EXPECT_GT(hidden, 10000);
  }
}

}  // namespace
}  // namespace sightline
