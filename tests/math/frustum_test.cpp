#include "sightline/math/frustum.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "sightline/scene/camera.h"
#include "tests/support/random_numbers.h"
#include "tests/support/square_view.h"

namespace sightline {
namespace {

using test::Random;

View randomView(Random& random, bool orthographic, double scale) {
  View view;
  view.eye = random.point(20.0) * scale;
  setOrientation(view, random.point(1.0), random.point(1.0));
  view.orthographic = orthographic;
  view.ortho_height = random.in(1.0, 40.0) * scale;
  view.tan_half_fovy = random.in(0.1, 3.0);
  view.aspect = random.in(0.3, 3.0);
  if (random.in(0.0, 1.0) < 0.5) {
    view.shift_x = random.in(-2.0, 2.0);
    view.shift_y = random.in(-2.0, 2.0);
  }
  view.z_near = random.in(0.01, 1.0) * scale;
  view.z_far = view.z_near + random.in(1.0, 60.0) * scale;
  return view;
}

Box randomBox(Random& random, double scale) {
  const Vec3d middle = random.point(60.0) * scale;
  const Vec3d half = abs(random.point(random.in(0.0, 30.0))) * scale;
  return {Vec3f(middle - half), Vec3f(middle + half)};
}

Vec3d cornerOf(const Box& box, int i) {
  return {(i & 1) != 0 ? box.max.x : box.min.x, (i & 2) != 0 ? box.max.y : box.min.y,
          (i & 4) != 0 ? box.max.z : box.min.z};
}

// Tests a point in clip space with the matrix, independently of the planes. w is the scale of the comparison.
bool insideByMatrix(const View& view, const Vec3d& point, double slack) {
  const Mat4 m = clipFromScene(view);
  double clip[4];
  for (int row = 0; row < 4; ++row) {
    clip[row] = m(row, 0) * point.x + m(row, 1) * point.y + m(row, 2) * point.z + m(row, 3);
  }
  const double w = clip[3] + slack * std::abs(clip[3]);
  return w > 0.0 && std::abs(clip[0]) <= w && std::abs(clip[1]) <= w && std::abs(clip[2]) <= w;
}

struct Case {
  const char* name;
  bool orthographic;
  double scale;  // metres
};

class FrustumOfView : public ::testing::TestWithParam<Case> {};

TEST_P(FrustumOfView, HasUnitNormalsThatPointInwards) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    Random random(seed);
    const View view = randomView(random, GetParam().orthographic, GetParam().scale);
    const double depth = 0.5 * (view.z_near + view.z_far);
    const double half_height = view.orthographic ? 0.5 * view.ortho_height : depth * view.tan_half_fovy;
    const Vec3d inside = view.eye + view.forward * depth +
                         view.right * (view.shift_x * half_height * view.aspect) +
                         view.up * (view.shift_y * half_height);
    for (const Plane& plane : frustumOf(view).planes) {
      EXPECT_NEAR(length(plane.normal), 1.0, 1e-12) << "seed " << seed;
      EXPECT_GT(plane.evaluate(inside), 0.0) << "seed " << seed;
    }
  }
}

TEST_P(FrustumOfView, HoldsThePointsThatTheMatrixPutsIntoTheClipVolume) {
  int inside = 0, outside = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    Random random(seed);
    const double scale = GetParam().scale;
    const View view = randomView(random, GetParam().orthographic, scale);
    const Frustum frustum = frustumOf(view);
    for (int i = 0; i < 200; ++i) {
      const Vec3d point = view.eye + view.forward * random.in(-0.2 * view.z_far, 1.2 * view.z_far) +
                          random.point(30.0) * scale;
      bool in_planes = true;
      for (const Plane& plane : frustum.planes) {
        in_planes &= plane.evaluate(point) >= 0.0;
      }
      const bool surely_in = insideByMatrix(view, point, -1e-6);
      const bool surely_out = !insideByMatrix(view, point, 1e-6);
      inside += surely_in ? 1 : 0;
      outside += surely_out ? 1 : 0;
      if (surely_in || surely_out) {
        EXPECT_EQ(in_planes, surely_in) << "seed " << seed << " point " << i;
      }
    }
  }
  EXPECT_GT(inside, 1000);
  EXPECT_GT(outside, 1000);
}

TEST_P(FrustumOfView, CallsNoBoxOutsideThatHoldsAPointOfTheView) {
  int outside = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    Random random(seed);
    const double scale = GetParam().scale;
    const View view = randomView(random, GetParam().orthographic, scale);
    const Frustum frustum = frustumOf(view);
    for (int i = 0; i < 60; ++i) {
      const Box box = randomBox(random, scale);
      std::uint8_t mask = kAllFrustumPlanes;
      if (classify(frustum, box, mask) != FrustumSide::kOutside) {
        continue;
      }
      ++outside;
      for (int k = 0; k < 60; ++k) {
        const Vec3d t(random.in(0, 1), random.in(0, 1), random.in(0, 1));
        const Vec3d low(box.min), high(box.max);
        const Vec3d point =
            low + Vec3d(t.x * (high.x - low.x), t.y * (high.y - low.y), t.z * (high.z - low.z));
        EXPECT_FALSE(insideByMatrix(view, k < 8 ? cornerOf(box, k) : point, -1e-9))
            << "seed " << seed << " box " << i;
      }
    }
  }
  EXPECT_GT(outside, 1000);
}

TEST_P(FrustumOfView, CallsABoxInsideOnlyWithAllItsCorners) {
  int inside = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    Random random(seed);
    const double scale = GetParam().scale;
    const View view = randomView(random, GetParam().orthographic, scale);
    const Frustum frustum = frustumOf(view);
    for (int i = 0; i < 60; ++i) {
      const Vec3d middle = view.eye + view.forward * random.in(view.z_near, view.z_far);
      const Vec3d half = abs(random.point(2.0)) * scale;
      const Box box{Vec3f(middle - half), Vec3f(middle + half)};
      std::uint8_t mask = kAllFrustumPlanes;
      const FrustumSide side = classify(frustum, box, mask);
      bool all_corners = true;
      for (int k = 0; k < 8; ++k) {
        all_corners &= insideByMatrix(view, cornerOf(box, k), 1e-6);
      }
      EXPECT_EQ(side == FrustumSide::kInside, mask == 0) << "seed " << seed << " box " << i;
      if (side == FrustumSide::kInside) {
        ++inside;
        EXPECT_TRUE(all_corners) << "seed " << seed << " box " << i;
      }
    }
  }
  EXPECT_GT(inside, 100);
}

TEST_P(FrustumOfView, ClearsAPlanesBitOnlyWhenEachPartOfTheBoxIsInsideOfIt) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    Random random(seed);
    const double scale = GetParam().scale;
    const View view = randomView(random, GetParam().orthographic, scale);
    const Frustum frustum = frustumOf(view);
    for (int i = 0; i < 40; ++i) {
      const Box box = randomBox(random, scale);
      std::uint8_t mask = kAllFrustumPlanes;
      const FrustumSide side = classify(frustum, box, mask);
      if (side == FrustumSide::kOutside) {
        continue;
      }
      for (std::size_t p = 0; p < 6; ++p) {
        if ((mask & (1u << p)) == 0) {
          for (int k = 0; k < 8; ++k) {
            EXPECT_GT(frustum.planes[p].evaluate(cornerOf(box, k)), 0.0) << "seed " << seed << " box " << i;
          }
        }
      }
      // For a part of the box, testing only the planes left in the mask gives the same result as testing all
      // planes.
      const Box part{box.min, Vec3f(center(box))};
      std::uint8_t left_over = mask, all = kAllFrustumPlanes;
      const FrustumSide by_rest = classify(frustum, part, left_over), by_all = classify(frustum, part, all);
      EXPECT_EQ(by_rest, by_all) << "seed " << seed << " box " << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Views, FrustumOfView,
                         ::testing::Values(Case{"Perspective", false, 1.0},
                                           Case{"PerspectiveMicrometres", false, 1e-6},
                                           Case{"PerspectiveMegametres", false, 1e6},
                                           Case{"Orthographic", true, 1.0},
                                           Case{"OrthographicMegametres", true, 1e6}),
                         [](const auto& param) { return std::string(param.param.name); });

View looksAlongMinusZ() {
  return test::squareView(1.0, 16.0);
}

FrustumSide sideOf(const View& view, const Box& box) {
  std::uint8_t mask = kAllFrustumPlanes;
  return classify(frustumOf(view), box, mask);
}

TEST(Frustum, ABoxThatTouchesAPlaneFromOutsideIsNotOutside) {
  for (const bool orthographic : {false, true}) {
    View view = looksAlongMinusZ();
    view.orthographic = orthographic;
    view.ortho_height = 8.0;
    EXPECT_NE(sideOf(view, {{-1, -1, -17}, {1, 1, -16}}), FrustumSide::kOutside);
    EXPECT_NE(sideOf(view, {{-1, -1, -1}, {1, 1, 0}}), FrustumSide::kOutside);
    EXPECT_NE(sideOf(view, {{4, -1, -4}, {5, 1, -2}}), FrustumSide::kOutside);
    EXPECT_NE(sideOf(view, {{-5, -1, -4}, {-4, 1, -2}}), FrustumSide::kOutside);
    EXPECT_NE(sideOf(view, {{-1, 4, -4}, {1, 9, -2}}), FrustumSide::kOutside);
    EXPECT_NE(sideOf(view, {{-1, -9, -4}, {1, -4, -2}}), FrustumSide::kOutside);
    const float beyond = std::nextafter(16.0f, 17.0f);
    EXPECT_EQ(sideOf(view, {{-1, -1, -17}, {1, 1, -beyond}}), FrustumSide::kOutside);
    EXPECT_EQ(sideOf(view, {{std::nextafter(4.0f, 5.0f), -1, -4}, {5, 1, -2}}), FrustumSide::kOutside);
  }
}

TEST(Frustum, OfAnOffCentreViewEndsWhereItsWindowDoes) {
  for (const bool orthographic : {false, true}) {
    // At a depth of 4 metres the window is 8 metres wide and high: x from -2 to 6, y from -8 to 0.
    View view = looksAlongMinusZ();
    view.orthographic = orthographic;
    view.ortho_height = 8.0;
    view.shift_x = 0.5;
    view.shift_y = -1.0;
    const float in = 0.01f;
    const auto at = [&](float x, float y) { return sideOf(view, {{x, y, -4}, {x, y, -4}}); };
    EXPECT_EQ(at(-2 + in, -8 + in), FrustumSide::kInside);
    EXPECT_EQ(at(6 - in, -in), FrustumSide::kInside);
    EXPECT_EQ(at(-2 - in, -4), FrustumSide::kOutside);
    EXPECT_EQ(at(6 + in, -4), FrustumSide::kOutside);
    EXPECT_EQ(at(0, -8 - in), FrustumSide::kOutside);
    EXPECT_EQ(at(0, in), FrustumSide::kOutside);
  }
}

TEST(Frustum, BoxesBehindTheEyeAreOutside) {
  EXPECT_EQ(sideOf(looksAlongMinusZ(), {{-1, -1, 1}, {1, 1, 3}}), FrustumSide::kOutside);
}

TEST(Frustum, FlatAndPointLikeBoxesAreAnsweredToo) {
  EXPECT_EQ(sideOf(looksAlongMinusZ(), {{1, 1, -8}, {1, 1, -8}}), FrustumSide::kInside);
  EXPECT_EQ(sideOf(looksAlongMinusZ(), {{-1, -1, -8}, {1, 1, -8}}), FrustumSide::kInside);
  EXPECT_EQ(sideOf(looksAlongMinusZ(), {{9, 1, -8}, {9, 1, -8}}), FrustumSide::kOutside);
}

TEST(Frustum, BoxesThatAreNotWellFormedAreNeverOutside) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  for (const Box& box :
       {Box{}, Box{{nan, 0, 90}, {1, 1, 91}}, Box{{-inf, 0, 90}, {1, 1, 91}}, Box{{1, 1, 91}, {0, 0, 90}},
        Box{{-inf, -inf, -inf}, {inf, inf, inf}}, Box{{nan, nan, nan}, {nan, nan, nan}}}) {
    std::uint8_t mask = kAllFrustumPlanes;
    EXPECT_EQ(classify(frustumOf(looksAlongMinusZ()), box, mask), FrustumSide::kIntersects);
    EXPECT_EQ(mask, kAllFrustumPlanes);
  }
}

TEST(Frustum, PlanesThatTheMaskLeavesOutAreNotTested) {
  const Box behind{{-1, -1, 1}, {1, 1, 3}};
  std::uint8_t none = 0;
  EXPECT_EQ(classify(frustumOf(looksAlongMinusZ()), behind, none), FrustumSide::kInside);
  std::uint8_t far_only = 1u << 5;
  EXPECT_EQ(classify(frustumOf(looksAlongMinusZ()), behind, far_only), FrustumSide::kInside);
}

}  // namespace
}  // namespace sightline
