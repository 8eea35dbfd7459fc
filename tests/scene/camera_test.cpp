#include "sightline/scene/camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace sightline {
namespace {

struct Clip {
  double x, y, z, w;
};

Clip project(const Mat4& clip_from_scene, const Vec3d& p) {
  const auto row = [&](int r) {
    return clip_from_scene(r, 0) * p.x + clip_from_scene(r, 1) * p.y + clip_from_scene(r, 2) * p.z +
           clip_from_scene(r, 3);
  };
  return {row(0), row(1), row(2), row(3)};
}

Vec3d randomVector(std::mt19937& random, double reach) {
  std::uniform_real_distribution<double> number(-reach, reach);
  const double x = number(random);
  const double y = number(random);
  const double z = number(random);
  return {x, y, z};
}

View randomView(std::mt19937& random) {
  View view;
  view.eye = randomVector(random, 100.0);
  setOrientation(view, randomVector(random, 1.0), randomVector(random, 1.0));
  view.orthographic = random() % 2 == 0;
  view.tan_half_fovy = 0.2 + 0.1 * static_cast<double>(random() % 10);
  view.ortho_height = 1.0 + static_cast<double>(random() % 50);
  view.aspect = 0.5 + 0.25 * static_cast<double>(random() % 8);
  view.shift_x = 0.25 * static_cast<double>(random() % 17) - 2.0;
  view.shift_y = 0.25 * static_cast<double>(random() % 17) - 2.0;
  view.z_near = 0.5;
  view.z_far = 80.0;
  return view;
}

void expectOrthonormal(const View& view) {
  EXPECT_NEAR(length(view.forward), 1.0, 1e-12);
  EXPECT_NEAR(length(view.up), 1.0, 1e-12);
  EXPECT_NEAR(dot(view.forward, view.up), 0.0, 1e-12);
  EXPECT_NEAR(length(cross(view.forward, view.up) - view.right), 0.0, 1e-12) << "right-handed";
}

TEST(Camera, OrientationIsOrthonormalForAnyDirection) {
  std::mt19937 random(7);
  for (int i = 0; i < 1000; ++i) {
    View view;
    const Vec3d forward = randomVector(random, 5.0);
    setOrientation(view, forward, randomVector(random, 5.0));
    expectOrthonormal(view);
    EXPECT_NEAR(dot(view.forward, normalized(forward)), 1.0, 1e-12);
  }
}

TEST(Camera, OrientationDoesNotDependOnTheLengthOfTheDirection) {
  std::mt19937 random(8);
  for (int i = 0; i < 100; ++i) {
    const Vec3d forward = normalized(randomVector(random, 5.0)), hint = randomVector(random, 5.0);
    View expected;
    setOrientation(expected, forward, hint);
    for (const double size : {1e-310, 1e-300, 1e-160, 1e-100, 1e100, 1e154, 1e300}) {
      for (const double hint_size : {1.0, size}) {
        View view;
        setOrientation(view, forward * size, hint * hint_size);
        EXPECT_TRUE(validate(view)) << size;
        EXPECT_LT(length(view.forward - expected.forward), 1e-12) << size;
        EXPECT_LT(length(view.up - expected.up), 1e-9) << size;
      }
    }
    CameraPath path;
    path.frames = {{.forward = forward * 1e-300, .up = hint * 1e300}};
    EXPECT_LT(length(path.view(0, {}).right - expected.right), 1e-9);
  }
}

TEST(Camera, OrientationSurvivesLookingAlongTheHint) {
  for (const Vec3d& axis : {Vec3d(0, 1, 0), Vec3d(0, -1, 0), Vec3d(1, 0, 0), Vec3d(0, 0, 3)}) {
    View view;
    setOrientation(view, axis, axis);
    expectOrthonormal(view);
    setOrientation(view, axis, -axis);
    expectOrthonormal(view);
    setOrientation(view, axis, {0, 0, 0});
    expectOrthonormal(view);
  }
}

// Hints go from an ordinary one to one that cannot be told from the direction; `off` is in radians.
TEST(Camera, OrientationIsOrthonormalHoweverNearTheHintIs) {
  constexpr double kFewRoundings = 0x1p-49;
  std::mt19937 random(11);
  for (double off = 1.0; off > 1e-18; off *= 0.5) {
    for (int i = 0; i < 100; ++i) {
      const Vec3d forward = normalized(randomVector(random, 5.0));
      const Vec3d side = normalized(cross(forward, randomVector(random, 5.0)));
      View view;
      setOrientation(view, forward, forward * (i % 2 == 0 ? 2.0 : -2.0) + side * (2.0 * off));
      for (const Vec3d& axis : {view.right, view.up, view.forward}) {
        ASSERT_NEAR(length(axis), 1.0, kFewRoundings) << off;
      }
      ASSERT_NEAR(dot(view.right, view.forward), 0.0, kFewRoundings) << off;
      ASSERT_NEAR(dot(view.right, view.up), 0.0, kFewRoundings) << off;
      ASSERT_NEAR(dot(view.up, view.forward), 0.0, kFewRoundings) << off;
      ASSERT_LT(dot(cross(view.right, view.up), view.forward), 0.0) << "right-handed";
      if (off > 1e-7) {
        ASSERT_GT(dot(view.up, side), 0.9) << off << ": up is the side of the hint";
      }
    }
  }
}

TEST(Camera, UpIsTheSideOfTheHint) {
  View view;
  setOrientation(view, {0, -0.9, -1}, {0, 1, 0});
  EXPECT_GT(view.up.y, 0.0);
  EXPECT_NEAR(view.right.x, 1.0, 1e-12) << "looking along -Z, +X is to the right";
}

TEST(Camera, ClipSpaceAndFrustumAgreeOnWhatIsInside) {
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    std::mt19937 random(seed);
    const View view = randomView(random);
    const Mat4 clip_from_scene = clipFromScene(view);
    const Frustum frustum = frustumOf(view);
    for (int i = 0; i < 200; ++i) {
      const Vec3d point = view.eye + randomVector(random, 100.0);
      const Clip clip = project(clip_from_scene, point);
      // Left, right, bottom, top, near, far.
      const double margins[6] = {clip.w + clip.x, clip.w - clip.x, clip.w + clip.y,
                                 clip.w - clip.y, clip.w + clip.z, clip.w - clip.z};
      for (std::size_t plane = 0; plane < 6; ++plane) {
        const double distance = frustum.planes[plane].evaluate(point);
        if (std::abs(distance) < 1e-6) {
          continue;
        }
        EXPECT_EQ(margins[plane] > 0.0, distance > 0.0) << "seed " << seed << " plane " << plane;
      }
    }
  }
}

// Boxes at a border of an orthographic picture, and at the far plane of a perspective one, from eyes that are
// far away. The test judges by long double, which on some machines could judge nothing.
TEST(Camera, NoBoxThatReachesIntoTheFrustumIsOutsideHoweverFarAwayTheEyeIs) {
  if (std::numeric_limits<long double>::digits < 64) {
    GTEST_SKIP() << "needs a long double of more digits to judge";
  }
  std::size_t inside = 0;
  for (const double away : {1e4, 1e6, 1e9, 1.5e11}) {
    for (std::uint32_t seed = 0; seed < 1000; ++seed) {
      std::mt19937 random(seed);
      View view;
      setOrientation(view, randomVector(random, 1.0), {0, 0, 1});
      view.eye = -view.forward * away;
      view.orthographic = seed % 2 == 0;
      view.z_far = view.orthographic ? 2.0 * away : away;
      view.aspect = 1.0;
      view.ortho_height = 100.0;
      // The axis along which a box only just reaches into the view, and how far the view goes.
      const Vec3d axis = view.orthographic ? view.right : view.forward;
      const Vec3d middle = randomVector(random, 1.0) + (view.orthographic ? view.right * 50.0 : Vec3d());
      Box box;
      long double nearest = 0.0L;
      for (int a = 0; a < 3; ++a) {
        box.min[a] = static_cast<float>(middle[a]);
        box.max[a] = box.min[a] + 1.0f;
        nearest += static_cast<long double>(axis[a]) *
                   (static_cast<long double>(axis[a] > 0.0 ? box.min[a] : box.max[a]) - view.eye[a]);
      }
      const double over = std::exp2(-46.0 + 36.0 * (seed % 100) / 100.0);
      (view.orthographic ? view.aspect : view.z_far) =
          static_cast<double>((nearest + over) / (view.orthographic ? 50.0L : 1.0L));
      const long double reach =
          (view.orthographic ? 50.0L * view.aspect : static_cast<long double>(view.z_far)) - nearest;
      if (reach > 0x1p-58L * away) {
        inside += 1;
        std::uint8_t mask = kAllFrustumPlanes;
        EXPECT_NE(classify(frustumOf(view), box, mask), FrustumSide::kOutside)
            << away << " " << seed << " " << static_cast<double>(reach);
      }
    }
  }
  EXPECT_GT(inside, 2000u);
}

// Axes count as unit vectors if their squares differ from 1 by at most 2^-20. Distances along such an axis
// are dot(axis, p - eye), as they are in clip space and for all methods.
TEST(Camera, BordersLieWhereAxesOfNearlyUnitLengthPutThem) {
  for (const double square : {1.0 - 0.99 * 0x1p-20, 1.0, 1.0 + 0.99 * 0x1p-20}) {
    const double size = std::sqrt(square), border = 1000.0 / size;
    const auto side = [](const View& view, float distance, const Vec3f& along) {
      const Vec3f at = along * distance, some(1, 1, 1);
      const Vec3f beside = some - Vec3f(abs(Vec3d(along)));
      std::uint8_t mask = kAllFrustumPlanes;
      return classify(frustumOf(view), Box{at - beside, at + beside}, mask);
    };
    const auto less = std::nextafter(static_cast<float>(border), 0.0f), more = less * (1.0f + 0x1p-20f);
    ASSERT_LE(size * double{less}, 1000.0);
    View view{.right = {1, 0, 0}, .up = {0, 1, 0}, .forward = {0, 0, -size}};
    view.z_far = 1000.0;
    EXPECT_NE(side(view, less, {0, 0, -1}), FrustumSide::kOutside) << size;
    EXPECT_EQ(side(view, more, {0, 0, -1}), FrustumSide::kOutside) << size;
    view.z_far = 1e5;
    view.z_near = 1000.0;
    EXPECT_EQ(side(view, less * (1.0f - 0x1p-20f), {0, 0, -1}), FrustumSide::kOutside) << size;
    EXPECT_NE(side(view, more, {0, 0, -1}), FrustumSide::kOutside) << size;

    View parallel{.right = {size, 0, 0}, .up = {0, size, 0}, .forward = {0, 0, -1}, .orthographic = true};
    parallel.ortho_height = 2000.0;
    parallel.aspect = 1.0;
    parallel.z_near = 0.0;
    for (const Vec3f& along : {Vec3f(1, 0, 0), Vec3f(-1, 0, 0), Vec3f(0, 1, 0), Vec3f(0, -1, 0)}) {
      EXPECT_NE(side(parallel, less, along), FrustumSide::kOutside) << size;
      EXPECT_EQ(side(parallel, more, along), FrustumSide::kOutside) << size;
    }
  }
}

TEST(Camera, FrustumPlanesHaveUnitNormals) {
  std::mt19937 random(3);
  for (int i = 0; i < 100; ++i) {
    for (const Plane& plane : frustumOf(randomView(random)).planes) {
      EXPECT_NEAR(length(plane.normal), 1.0, 1e-12);
    }
  }
}

TEST(Camera, CornersOfThePictureProjectToTheCornersOfClipSpace) {
  View view;
  view.eye = {10, 20, 30};
  setOrientation(view, {0, 0, -1}, {0, 1, 0});
  view.tan_half_fovy = 0.5;
  view.aspect = 2.0;
  view.z_near = 1.0;
  view.z_far = 9.0;
  // At 2 metres distance, the view is 4 metres wide and 2 metres high.
  Clip clip = project(clipFromScene(view), {12, 21, 28});
  EXPECT_NEAR(clip.x / clip.w, 1.0, 1e-12);
  EXPECT_NEAR(clip.y / clip.w, 1.0, 1e-12);
  clip = project(clipFromScene(view), {10, 20, 29});
  EXPECT_NEAR(clip.z / clip.w, -1.0, 1e-12) << "on the near plane";
  clip = project(clipFromScene(view), {10, 20, 21});
  EXPECT_NEAR(clip.z / clip.w, 1.0, 1e-12) << "on the far plane";

  view.orthographic = true;
  view.ortho_height = 6.0;
  clip = project(clipFromScene(view), {4, 17, 25});
  EXPECT_NEAR(clip.w, 1.0, 1e-12);
  EXPECT_NEAR(clip.x, -1.0, 1e-12);
  EXPECT_NEAR(clip.y, -1.0, 1e-12);
  EXPECT_NEAR(clip.z, 0.0, 1e-12) << "half way between near and far";
}

TEST(Camera, NearAndFarPlanesProjectToTheEndsOfClipSpaceAtAnyDistance) {
  for (const double z_near : {1e-190, 1e-20, 1.0, 1e20, 1e190}) {
    View view;
    setOrientation(view, {0, 0, -1}, {0, 1, 0});
    view.z_near = z_near;
    view.z_far = 1e10 * z_near;
    Clip clip = project(clipFromScene(view), {0, 0, -view.z_near});
    EXPECT_NEAR(clip.z / clip.w, -1.0, 1e-9) << z_near;
    clip = project(clipFromScene(view), {0, 0, -view.z_far});
    EXPECT_NEAR(clip.z / clip.w, 1.0, 1e-9) << z_near;
  }
}

TEST(Camera, TheMiddleOfAnOffCentrePictureLiesOffTheForwardAxis) {
  View view;
  view.eye = {10, 20, 30};
  setOrientation(view, {0, 0, -1}, {0, 1, 0});
  view.tan_half_fovy = 0.5;
  view.aspect = 2.0;
  view.shift_x = 0.5;
  view.shift_y = -1.5;
  // At 2 metres distance, half the picture is 2 metres wide and 1 metre high.
  Clip clip = project(clipFromScene(view), {11, 18.5, 28});
  EXPECT_NEAR(clip.x, 0.0, 1e-12);
  EXPECT_NEAR(clip.y, 0.0, 1e-12);
  clip = project(clipFromScene(view), {13, 19.5, 28});
  EXPECT_NEAR(clip.x / clip.w, 1.0, 1e-12);
  EXPECT_NEAR(clip.y / clip.w, 1.0, 1e-12);
  view.orthographic = true;
  view.ortho_height = 2.0;
  clip = project(clipFromScene(view), {11, 18.5, 25});
  EXPECT_NEAR(clip.x, 0.0, 1e-12);
  EXPECT_NEAR(clip.y, 0.0, 1e-12);
  clip = project(clipFromScene(view), {9, 17.5, 25});
  EXPECT_NEAR(clip.x, -1.0, 1e-12);
  EXPECT_NEAR(clip.y, -1.0, 1e-12);
}

TEST(Camera, NearDistanceReachesTheCornersOfTheNearPlane) {
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    std::mt19937 random(seed);
    View view = randomView(random);
    view.orthographic = false;
    double farthest = 0.0;
    for (const double x : {-1.0, 1.0}) {
      for (const double y : {-1.0, 1.0}) {
        // Converts the corner (x, y) of the near plane back from clip space.
        const Vec3d corner =
            view.forward * view.z_near +
            view.right * (view.z_near * view.tan_half_fovy * view.aspect * (x + view.shift_x)) +
            view.up * (view.z_near * view.tan_half_fovy * (y + view.shift_y));
        const Clip clip = project(clipFromScene(view), view.eye + corner);
        EXPECT_NEAR(clip.x / clip.w, x, 1e-9) << "seed " << seed;
        EXPECT_NEAR(clip.y / clip.w, y, 1e-9) << "seed " << seed;
        EXPECT_NEAR(clip.z / clip.w, -1.0, 1e-9) << "seed " << seed;
        farthest = std::max(farthest, length(corner));
      }
    }
    EXPECT_GE(nearDistance(view), farthest) << "seed " << seed;
    EXPECT_LE(nearDistance(view), farthest * (1.0 + 1e-12)) << "seed " << seed;
  }
}

// The point p with dot(rows[i], p) = values[i], by elimination.
Vec3d solved(std::array<Vec3d, 3> rows, Vec3d values) {
  for (int i = 0; i < 3; ++i) {
    const double scale = 1.0 / rows[static_cast<std::size_t>(i)][i];
    rows[static_cast<std::size_t>(i)] = rows[static_cast<std::size_t>(i)] * scale;
    values[i] *= scale;
    for (int k = 0; k < 3; ++k) {
      if (k != i) {
        const double times = rows[static_cast<std::size_t>(k)][i];
        values[k] -= times * values[i];
        rows[static_cast<std::size_t>(k)] =
            rows[static_cast<std::size_t>(k)] - rows[static_cast<std::size_t>(i)] * times;
      }
    }
  }
  return values;
}

TEST(Camera, NearDistanceReachesTheCornersWhereAxesAreNotQuitePerpendicular) {
  std::size_t views = 0;
  for (std::uint32_t seed = 0; seed < 2000; ++seed) {
    std::mt19937 random(seed);
    View view;
    setOrientation(view, Vec3d(0.1, 0.2, -1) + randomVector(random, 0.1), {0, 1, 0});
    for (Vec3d* axis : {&view.right, &view.up, &view.forward}) {
      *axis = *axis + randomVector(random, 4e-7);
    }
    const Result<View> usable = validate(view);
    if (!usable || usable->forward != view.forward || usable->right != view.right || usable->up != view.up) {
      continue;
    }
    views += 1;
    double farthest = 0.0;
    for (const double x : {-1.0, 1.0}) {
      for (const double y : {-1.0, 1.0}) {
        const Vec3d distances{x * view.tan_half_fovy * view.aspect, y * view.tan_half_fovy, 1.0};
        farthest =
            std::max(farthest, view.z_near * length(solved({view.right, view.up, view.forward}, distances)));
      }
    }
    EXPECT_GE(nearDistance(view), farthest * (1.0 - 1e-14)) << "seed " << seed;
    EXPECT_LE(nearDistance(view), farthest * (1.0 + 1e-13)) << "seed " << seed;
  }
  EXPECT_GT(views, 200u);
}

TEST(Camera, NearDistanceOfAnOrthographicViewIsInfinite) {
  View view;
  view.orthographic = true;
  EXPECT_TRUE(std::isinf(nearDistance(view)));
}

TEST(CameraPath, ViewsAreInSceneSpace) {
  CameraPath path;
  path.fovy_deg = 90.0;
  path.width = 300;
  path.height = 200;
  path.z_near = 0.25;
  path.z_far = 70.0;
  path.shift_x = 0.25;
  path.shift_y = -3.0;
  path.frames = {{{5e6 + 1.5, 0, 0}, {0, 0, -4}, {0, 2, 0}}, {{5e6, 3, 0}, {1, 0, 0}, {0, 1, 0}}};
  const View view = path.view(0, {5e6, 0, 10});
  EXPECT_EQ(view.eye, Vec3d(1.5, 0, -10));
  EXPECT_EQ(view.forward, Vec3d(0, 0, -1));
  EXPECT_FALSE(view.orthographic);
  EXPECT_NEAR(view.tan_half_fovy, 1.0, 1e-12);
  EXPECT_EQ(view.aspect, 1.5);
  EXPECT_EQ(view.z_near, 0.25);
  EXPECT_EQ(view.z_far, 70.0);
  EXPECT_EQ(view.shift_x, 0.25);
  EXPECT_EQ(view.shift_y, -3.0);
  EXPECT_EQ(path.view(1, {5e6, 0, 0}).eye, Vec3d(0, 3, 0));
  path.ortho_height = 8.0;
  EXPECT_TRUE(path.view(0, {}).orthographic);
  EXPECT_EQ(path.view(0, {}).ortho_height, 8.0);
}

}  // namespace
}  // namespace sightline
