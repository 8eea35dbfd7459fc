#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "sightline/math/box.h"
#include "sightline/scene/camera.h"

namespace sightline {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinite = std::numeric_limits<double>::infinity();

View viewAlong(const Vec3d& forward) {
  View view;
  view.eye = {3, -2, 7};
  setOrientation(view, forward, {0, 1, 0});
  return view;
}

void expectSameAxes(const View& a, const View& b) {
  EXPECT_NEAR(length(a.right - b.right), 0.0, 1e-12);
  EXPECT_NEAR(length(a.up - b.up), 0.0, 1e-12);
  EXPECT_NEAR(length(a.forward - b.forward), 0.0, 1e-12);
}

// Expects an error whose message names the invalid member.
void expectError(const View& view, const std::string& member) {
  const Result<View> result = validate(view);
  ASSERT_FALSE(result) << member;
  EXPECT_NE(result.error().message.find(member), std::string::npos) << result.error().message;
}

TEST(ValidateView, LeavesAViewAsItIsThatIsOrthonormalToSinglePrecision) {
  std::mt19937_64 random(5);
  const auto number = [&] { return 2.0 * static_cast<double>(random() >> 11) * 0x1p-53 - 1.0; };
  for (int i = 0; i < 1000; ++i) {
    View view = viewAlong({number(), number(), number()});
    for (Vec3d* axis : {&view.right, &view.up, &view.forward}) {
      *axis = Vec3d(Vec3f(*axis));
    }
    const Result<View> result = validate(view);
    ASSERT_TRUE(result);
    EXPECT_EQ(result->right, view.right);
    EXPECT_EQ(result->up, view.up);
    EXPECT_EQ(result->forward, view.forward);
  }
}

TEST(ValidateView, NormalisesAxesOfAnyLength) {
  const View unit = viewAlong({1, 0.5, -2});
  for (const double scale : {0.01, 0.999, 1.5, 3.0, 1e-160, 1e160}) {
    View view = unit;
    view.right = view.right * scale;
    view.up = view.up * (2.0 * scale);
    view.forward = view.forward * (0.5 * scale);
    const Result<View> result = validate(view);
    ASSERT_TRUE(result) << scale;
    expectSameAxes(*result, unit);
  }
}

TEST(ValidateView, RefusesAxesOfWhichAnyTwoAreNotPerpendicular) {
  for (int pair = 0; pair < 3; ++pair) {
    for (const double skew : {-0.5, -1e-4, 1e-4, 0.5}) {
      View view = viewAlong({1, 0.5, -2});
      const View straight = view;
      Vec3d* const axes[] = {&view.right, &view.up, &view.forward};
      const Vec3d other[] = {straight.up, straight.forward, straight.right};
      *axes[pair] = normalized(*axes[pair] + other[pair] * skew);
      expectError(view, "perpendicular");
    }
  }
}

TEST(ValidateView, MirrorsALeftHandedBasis) {
  const View right_handed = viewAlong({1, 0.5, -2});
  View view = right_handed;
  view.right = -view.right;
  view.shift_x = 0.5;
  view.shift_y = 0.75;
  const Result<View> result = validate(view);
  ASSERT_TRUE(result);
  expectSameAxes(*result, right_handed);
  EXPECT_EQ(result->shift_x, -0.5) << "the window stays where it is";
  EXPECT_EQ(result->shift_y, 0.75);
}

TEST(ValidateView, AcceptsANearDistanceOfZeroAndAnInfiniteFarOne) {
  for (const bool orthographic : {false, true}) {
    View view = viewAlong({0, 0, -1});
    view.orthographic = orthographic;
    view.z_near = 0.0;
    view.z_far = kInfinite;
    EXPECT_TRUE(validate(view));
  }
}

TEST(ValidateView, NamesTheMemberThatMakesNoView) {
  const View good = viewAlong({1, 0.5, -2});
  for (const double bad : {kNan, kInfinite}) {
    for (int axis = 0; axis < 3; ++axis) {
      View view = good;
      view.eye[axis] = bad;
      expectError(view, "View::eye");
      for (Vec3d View::*vector : {&View::right, &View::up, &View::forward}) {
        view = good;
        (view.*vector)[axis] = bad;
        expectError(view, "forward");
      }
    }
  }
  for (Vec3d View::*vector : {&View::right, &View::up, &View::forward}) {
    View view = good;
    view.*vector = {};
    expectError(view, "not zero");
    view = good;
    view.*vector = normalized(good.right + good.up * 0.3 - good.forward * 0.2);
    expectError(view, "perpendicular");
  }
  View askew = good;  // the axes are off by less than a tenth of a degree
  askew.forward = normalized(good.forward + good.right * 0.0009);
  expectError(askew, "perpendicular");
  for (const bool orthographic : {false, true}) {
    View endless = good;
    endless.orthographic = orthographic;
    endless.tan_half_fovy = endless.ortho_height = endless.aspect = 1e155;
    expectError(endless, "View::aspect");
  }
  View twice = good;
  twice.up = twice.right;
  expectError(twice, "perpendicular");
  for (const double bad : {0.0, -1.0, kNan, kInfinite}) {
    View view = good;
    view.tan_half_fovy = bad;
    expectError(view, "View::tan_half_fovy");
    view.orthographic = true;
    EXPECT_TRUE(validate(view)) << "an orthographic view has no angle";
    view.ortho_height = bad;
    expectError(view, "View::ortho_height");
    view = good;
    view.aspect = bad;
    expectError(view, "View::aspect");
  }
  for (const double bad : {1000.001, -1001.0, 1e300, kNan, kInfinite, -kInfinite}) {
    for (double View::*shift : {&View::shift_x, &View::shift_y}) {
      View view = good;
      view.*shift = View::kMaxShift;
      EXPECT_TRUE(validate(view));
      view.*shift = bad;
      expectError(view, "View::shift_x and shift_y");
    }
  }
  for (const double bad : {-1e-9, -1.0, kNan, kInfinite}) {
    View view = good;
    view.z_near = bad;
    expectError(view, "View::z_near");
  }
  for (const double bad : {good.z_near, 0.0, -1.0, kNan}) {
    View view = good;
    view.z_far = bad;
    expectError(view, "View::z_far");
  }
}

TEST(FrustumOfAnOddView, HoldsEverythingWhereThereIsNoView) {
  View view = viewAlong({0, 0, -1});
  view.aspect = -1.0;
  const Frustum frustum = frustumOf(view);
  std::uint8_t mask = kAllFrustumPlanes;
  EXPECT_EQ(classify(frustum, Box{{1e6, 1e6, 1e6}, {2e6, 2e6, 2e6}}, mask), FrustumSide::kInside);
}

TEST(FrustumOfAnOddView, WithAnInfiniteFarDistanceHasNoEnd) {
  View view = viewAlong({0, 0, -1});
  view.z_far = kInfinite;
  std::uint8_t mask = kAllFrustumPlanes;
  EXPECT_EQ(classify(frustumOf(view), Box{{-1, -1, -1e30f}, {1, 1, -0.9e30f}}, mask), FrustumSide::kInside);
  mask = kAllFrustumPlanes;
  EXPECT_EQ(classify(frustumOf(view), Box{{-1, -1, 1e3f}, {1, 1, 1e4f}}, mask), FrustumSide::kOutside);
}

TEST(FrustumOfAnOddView, MeasuresNearAndFarInMetresWhateverTheLengthOfForward) {
  View view = viewAlong({0, 0, -1});
  view.eye = {};
  view.z_near = 1.0;
  view.z_far = 10.0;
  view.forward = view.forward * 0.01;
  const Frustum frustum = frustumOf(view);
  std::uint8_t mask = kAllFrustumPlanes;
  EXPECT_EQ(classify(frustum, Box{{-0.1f, -0.1f, -6}, {0.1f, 0.1f, -5}}, mask), FrustumSide::kInside);
  mask = kAllFrustumPlanes;
  EXPECT_EQ(classify(frustum, Box{{-0.1f, -0.1f, -0.9f}, {0.1f, 0.1f, -0.5f}}, mask), FrustumSide::kOutside);
}

TEST(ClipFromScene, TakesAxesOfOtherLengthsAsTheFrustumDoes) {
  View view = viewAlong({0, 0, -1});
  const Mat4 unit = clipFromScene(view);
  view.right = view.right * 0.5;
  view.up = view.up * 3.0;
  view.forward = view.forward * 0.1;
  const Mat4 scaled = clipFromScene(view);
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      EXPECT_NEAR(scaled(row, column), unit(row, column), 1e-12);
    }
  }
}

// The clip-space depth equals that of a very far plane.
TEST(ClipFromScene, WithAnInfiniteFarDistanceIsTheLimit) {
  for (const bool orthographic : {false, true}) {
    View view = viewAlong({1, 0.5, -2});
    view.orthographic = orthographic;
    view.z_far = 1e15;
    const Mat4 far_away = clipFromScene(view);
    view.z_far = kInfinite;
    const Mat4 infinite = clipFromScene(view);
    for (int row = 0; row < 4; ++row) {
      for (int column = 0; column < 4; ++column) {
        EXPECT_NEAR(infinite(row, column), far_away(row, column), 1e-12);
      }
    }
  }
}

}  // namespace
}  // namespace sightline
