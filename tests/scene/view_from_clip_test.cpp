#include "sightline/scene/view_from_clip.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "sightline/math/frustum.h"
#include "tests/support/random_numbers.h"

namespace sightline {
namespace {

constexpr double kEndless = std::numeric_limits<double>::infinity();
constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

using test::Random;

bool chance(Random& random) {
  return (random.bits() >> 20 & 1) != 0;
}

Mat4 fromRows(const std::array<double, 16>& rows) {
  return transposed(Mat4{rows});
}

// ---- Projections as their definitions give them.

struct Window {
  double left, right, bottom, top, near, far;
};

// glFrustum()
Mat4 glFrustum(const Window& w) {
  const double width = w.right - w.left, height = w.top - w.bottom, depth = w.far - w.near;
  return fromRows({2 * w.near / width, 0, (w.right + w.left) / width, 0,          //
                   0, 2 * w.near / height, (w.top + w.bottom) / height, 0,        //
                   0, 0, -(w.far + w.near) / depth, -2 * w.far * w.near / depth,  //
                   0, 0, -1, 0});
}

// glOrtho()
Mat4 glOrtho(const Window& w) {
  const double width = w.right - w.left, height = w.top - w.bottom, depth = w.far - w.near;
  return fromRows({2 / width, 0, 0, -(w.right + w.left) / width,    //
                   0, 2 / height, 0, -(w.top + w.bottom) / height,  //
                   0, 0, -2 / depth, -(w.far + w.near) / depth,     //
                   0, 0, 0, 1});
}

// D3DXMatrixPerspectiveOffCenterLH(), which is for row vectors: transposed here. The view looks along +z.
Mat4 d3dOffCenterLeftHanded(const Window& w) {
  const double width = w.right - w.left, height = w.top - w.bottom, depth = w.far - w.near;
  return transposed(fromRows({2 * w.near / width, 0, 0, 0,   //
                              0, 2 * w.near / height, 0, 0,  //
                              (w.left + w.right) / (w.left - w.right),
                              (w.top + w.bottom) / (w.bottom - w.top), w.far / depth, 1,  //
                              0, 0, w.near * w.far / (w.near - w.far), 0}));
}

// Depth from 1 to 0, without an end; right-handed.
Mat4 reversedInfinite(const Window& w) {
  const double width = w.right - w.left, height = w.top - w.bottom;
  return fromRows({2 * w.near / width, 0, (w.right + w.left) / width, 0,    //
                   0, 2 * w.near / height, (w.top + w.bottom) / height, 0,  //
                   0, 0, 0, w.near,                                         //
                   0, 0, -1, 0});
}

// gluLookAt() from an eye and orthonormal axes.
Mat4 lookAt(const View& view) {
  const Vec3d r = view.right, u = view.up, b = -view.forward;
  return fromRows({r.x, r.y, r.z, -dot(r, view.eye),  //
                   u.x, u.y, u.z, -dot(u, view.eye),  //
                   b.x, b.y, b.z, -dot(b, view.eye),  //
                   0, 0, 0, 1});
}

Mat4 scaling(double x, double y, double z) {
  return fromRows({x, 0, 0, 0, 0, y, 0, 0, 0, 0, z, 0, 0, 0, 0, 1});
}

Mat4 inSinglePrecision(const Mat4& m) {
  std::array<float, 16> floats{};
  for (std::size_t i = 0; i < 16; ++i) {
    floats[i] = static_cast<float>(m.m[i]);
  }
  return mat4FromColumns(floats);
}

constexpr Window kWindow{-0.3, 0.5, -0.2, 0.1, 0.25, 80.0};

View someCamera() {
  View view;
  view.eye = {12, -3, 40};
  setOrientation(view, {1, 0.25, -2}, {0.1, 1, 0});
  return view;
}

// What the window above is as a view.
void expectWindow(const View& view, const Window& w, double far) {
  const View camera = someCamera();
  EXPECT_NEAR(length(view.eye - camera.eye), 0.0, 1e-12);
  EXPECT_NEAR(length(view.right - camera.right), 0.0, 1e-12);
  EXPECT_NEAR(length(view.up - camera.up), 0.0, 1e-12);
  EXPECT_NEAR(length(view.forward - camera.forward), 0.0, 1e-12);
  EXPECT_FALSE(view.orthographic);
  EXPECT_NEAR(view.tan_half_fovy, 0.5 * (w.top - w.bottom) / w.near, 1e-12);
  EXPECT_NEAR(view.aspect, (w.right - w.left) / (w.top - w.bottom), 1e-12);
  EXPECT_NEAR(view.shift_x, (w.right + w.left) / (w.right - w.left), 1e-12);
  EXPECT_NEAR(view.shift_y, (w.top + w.bottom) / (w.top - w.bottom), 1e-12);
  EXPECT_NEAR(view.z_near, w.near, 1e-12 * w.near);
  if (std::isinf(far)) {
    EXPECT_EQ(view.z_far, far);
  } else {
    EXPECT_NEAR(view.z_far, far, 1e-11 * far);
  }
}

void expectView(const Result<View>& view, double far) {
  ASSERT_TRUE(view) << view.error().message;
  expectWindow(*view, kWindow, far);
}

TEST(ViewFromClip, ReadsGlFrustum) {
  expectView(viewFromClip(glFrustum(kWindow) * lookAt(someCamera()), {}), kWindow.far);
}

TEST(ViewFromClip, ReadsTheOffCentreProjectionOfDirect3D) {
  // A left-handed view matrix differs in the sign of z alone.
  const Mat4 view = scaling(1, 1, -1) * lookAt(someCamera());
  expectView(viewFromClip(d3dOffCenterLeftHanded(kWindow) * view, {.depth = ClipDepth::kZeroToOne}),
             kWindow.far);
}

TEST(ViewFromClip, ReadsReversedDepthWithoutAnEnd) {
  const Mat4 clip = reversedInfinite(kWindow) * lookAt(someCamera());
  expectView(viewFromClip(clip, {.depth = ClipDepth::kOneToZero}), kEndless);
}

TEST(ViewFromClip, ReadsReversedDepthWithAnEnd) {
  const Mat4 view = scaling(1, 1, -1) * lookAt(someCamera());
  Mat4 clip = d3dOffCenterLeftHanded(kWindow) * view;
  for (int column = 0; column < 4; ++column) {
    clip(2, column) = clip(3, column) - clip(2, column);
  }
  expectView(viewFromClip(clip, {.depth = ClipDepth::kOneToZero}), kWindow.far);
}

TEST(ViewFromClip, ReadsTheDownwardPicturesOfVulkan) {
  const Mat4 view = scaling(1, 1, -1) * lookAt(someCamera());
  const Mat4 clip = scaling(1, -1, 1) * d3dOffCenterLeftHanded(kWindow) * view;
  expectView(viewFromClip(clip, {.depth = ClipDepth::kZeroToOne, .y_down = true}), kWindow.far);
  // Unless the caller says so, the view is upside down: the same volume.
  const Result<View> turned = viewFromClip(clip, {.depth = ClipDepth::kZeroToOne});
  ASSERT_TRUE(turned);
  EXPECT_NEAR(length(turned->up + someCamera().up), 0.0, 1e-12);
  EXPECT_NEAR(length(turned->right + someCamera().right), 0.0, 1e-12);
  EXPECT_NEAR(turned->shift_x, -0.25, 1e-12);
  EXPECT_NEAR(turned->shift_y, 1.0 / 3.0, 1e-12);
}

TEST(ViewFromClip, MirrorsALeftHandedSceneAsValidateDoes) {
  const Mat4 clip = glFrustum(kWindow) * scaling(-1, 1, 1) * lookAt(someCamera());
  const Result<View> view = viewFromClip(clip, {});
  ASSERT_TRUE(view);
  EXPECT_NEAR(length(view->right - someCamera().right), 0.0, 1e-12);
  EXPECT_NEAR(view->shift_x, -0.25, 1e-12);
  EXPECT_NEAR(view->shift_y, -1.0 / 3.0, 1e-12);
}

TEST(ViewFromClip, ReadsAPictureThatIsTurnedByAQuarter) {
  const Mat4 quarter = fromRows({0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});
  const Result<View> view = viewFromClip(quarter * glFrustum(kWindow) * lookAt(someCamera()), {});
  ASSERT_TRUE(view);
  EXPECT_NEAR(length(view->up - someCamera().right), 0.0, 1e-12);
  EXPECT_NEAR(length(view->right + someCamera().up), 0.0, 1e-12);
  EXPECT_NEAR(view->aspect, 3.0 / 8.0, 1e-12);
  EXPECT_NEAR(view->shift_y, 0.25, 1e-12);
  EXPECT_NEAR(view->shift_x, 1.0 / 3.0, 1e-12);
}

TEST(ViewFromClip, MeasuresInTheUnitsOfTheScene) {
  // The view matrix turns metres of the scene into centimetres; the projection is in centimetres.
  Window centimetres = kWindow;
  for (double* length : {&centimetres.left, &centimetres.right, &centimetres.bottom, &centimetres.top,
                         &centimetres.near, &centimetres.far}) {
    *length *= 100.0;
  }
  expectView(viewFromClip(glFrustum(centimetres) * scaling(100, 100, 100) * lookAt(someCamera()), {}),
             kWindow.far);
}

TEST(ViewFromClip, ReadsTheShiftOfAJitteredPicture) {
  const double width = 1920, height = 1080;
  const Window symmetric{-0.4, 0.4, -0.3, 0.3, 0.5, 100};
  for (const Vec3d& pixels : {Vec3d(0.25, -0.375, 0), Vec3d(-0.5, 0.125, 0)}) {
    Mat4 projection = glFrustum(symmetric);
    // The picture moves by so many pixels to the right and up: the window moves to the left and down.
    projection(0, 2) -= 2 * pixels.x / width;
    projection(1, 2) -= 2 * pixels.y / height;
    const Result<View> view = viewFromClip(projection * lookAt(someCamera()), {});
    ASSERT_TRUE(view);
    EXPECT_NEAR(view->shift_x, -2 * pixels.x / width, 1e-15);
    EXPECT_NEAR(view->shift_y, -2 * pixels.y / height, 1e-15);
    EXPECT_NEAR(view->tan_half_fovy, 0.6, 1e-15);
  }
}

TEST(ViewFromClip, PutsTheEyeOfAnOrthographicViewOnItsNearPlane) {
  const Window box{-3, 5, -2, 1, -10, 80};  // 10 metres behind the camera, as engines' shadow maps begin
  const View camera = someCamera();
  const Result<View> view = viewFromClip(glOrtho(box) * lookAt(camera), {});
  ASSERT_TRUE(view) << view.error().message;
  EXPECT_TRUE(view->orthographic);
  EXPECT_NEAR(view->ortho_height, 3.0, 1e-12);
  EXPECT_NEAR(view->aspect, 8.0 / 3.0, 1e-12);
  EXPECT_EQ(view->z_near, 0.0);
  EXPECT_NEAR(view->z_far, 90.0, 1e-10);
  EXPECT_EQ(view->shift_x, 0.0);
  EXPECT_EQ(view->shift_y, 0.0);
  const Vec3d eye = camera.eye + camera.right * 1.0 - camera.up * 0.5 - camera.forward * 10.0;
  EXPECT_NEAR(length(view->eye - eye), 0.0, 1e-11);
  EXPECT_NEAR(length(view->forward - camera.forward), 0.0, 1e-12);
}

TEST(ViewFromClip, ReadsTheDepthOfAnOrthographicViewInAnyRange) {
  const Mat4 look = lookAt(someCamera());
  const Mat4 clip = glOrtho(kWindow) * look;
  const Result<View> expected = viewFromClip(clip, {});
  ASSERT_TRUE(expected);
  for (const bool reversed : {false, true}) {
    Mat4 other = clip;
    for (int column = 0; column < 4; ++column) {
      other(2, column) = 0.5 * (clip(3, column) + clip(2, column) * (reversed ? -1.0 : 1.0));
    }
    const Result<View> view =
        viewFromClip(other, {.depth = reversed ? ClipDepth::kOneToZero : ClipDepth::kZeroToOne});
    ASSERT_TRUE(view);
    EXPECT_NEAR(length(view->eye - expected->eye), 0.0, 1e-10);
    EXPECT_NEAR(length(view->forward - expected->forward), 0.0, 1e-12);
    EXPECT_NEAR(view->z_far, expected->z_far, 1e-10);
  }
}

// ---- Any matrix of a view.

View randomView(Random& random, bool orthographic) {
  View view;
  view.eye = random.point(chance(random) ? 20.0 : 1e5);
  setOrientation(view, random.point(1.0), random.point(1.0));
  view.orthographic = orthographic;
  view.ortho_height = random.in(1.0, 40.0);
  view.tan_half_fovy = random.in(0.05, 3.0);
  view.aspect = random.in(0.3, 3.0);
  view.shift_x = random.in(-3.0, 3.0);
  view.shift_y = chance(random) ? random.in(-3.0, 3.0) : 0.0;
  view.z_near = random.in(0.01, 1.0);
  view.z_far = chance(random) && !orthographic ? kEndless : view.z_near + random.in(1.0, 1000.0);
  return view;
}

TEST(ViewFromClip, IsTheInverseOfClipFromScene) {
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    Random random(seed);
    const View view = randomView(random, false);
    const Result<View> found = viewFromClip(clipFromScene(view), {});
    ASSERT_TRUE(found) << "seed " << seed << ": " << found.error().message;
    const double slack = 1e-12 * (1.0 + length(view.eye));
    EXPECT_NEAR(length(found->eye - view.eye), 0.0, slack) << "seed " << seed;
    EXPECT_NEAR(length(found->right - view.right), 0.0, 1e-12) << "seed " << seed;
    EXPECT_NEAR(length(found->up - view.up), 0.0, 1e-12) << "seed " << seed;
    EXPECT_NEAR(length(found->forward - view.forward), 0.0, 1e-12) << "seed " << seed;
    EXPECT_NEAR(found->tan_half_fovy, view.tan_half_fovy, 1e-12) << "seed " << seed;
    EXPECT_NEAR(found->aspect, view.aspect, 1e-12) << "seed " << seed;
    EXPECT_NEAR(found->shift_x, view.shift_x, 1e-12) << "seed " << seed;
    EXPECT_NEAR(found->shift_y, view.shift_y, 1e-12) << "seed " << seed;
    EXPECT_NEAR(found->z_near, view.z_near, slack) << "seed " << seed;
    if (std::isinf(view.z_far)) {
      EXPECT_GT(found->z_far, 1e12 * view.z_near) << "seed " << seed;
    } else {
      EXPECT_NEAR(found->z_far, view.z_far, 1e-10 * (1.0 + length(view.eye)) * view.z_far / view.z_near)
          << "seed " << seed;
    }
  }
}

// Changes OpenGL's depths to others.
Mat4 withDepth(Mat4 clip, ClipDepth depth) {
  for (int column = 0; column < 4 && depth != ClipDepth::kMinusOneToOne; ++column) {
    const double z = 0.5 * (clip(3, column) + clip(2, column));
    clip(2, column) = depth == ClipDepth::kZeroToOne ? z : clip(3, column) - z;
  }
  return clip;
}

// The borders of what the matrix shows, in long double: positive inside. Left, right, bottom, top, near, far.
std::array<long double, 6> margins(const Mat4& clip, const ClipDepth depth, const Vec3d& point) {
  const auto row = [&](int r) {
    return static_cast<long double>(clip(r, 0)) * point.x + static_cast<long double>(clip(r, 1)) * point.y +
           static_cast<long double>(clip(r, 2)) * point.z + static_cast<long double>(clip(r, 3));
  };
  const long double x = row(0), y = row(1), z = row(2), w = row(3);
  const bool reversed = depth == ClipDepth::kOneToZero;
  const long double low = depth == ClipDepth::kMinusOneToOne ? z + w : z;
  return {w + x, w - x, w + y, w - y, reversed ? w - z : low, reversed ? low : w - z};
}

// Points close to each plane of the view are where the matrix says, as soon as they are clear of it by the
// relative error that is promised.
TEST(ViewFromClip, HasThePlanesOfTheMatrixEvenInSinglePrecision) {
  int compared = 0;
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    Random random(seed);
    const bool orthographic = seed % 4 == 0;
    const View view = randomView(random, orthographic);
    const ClipDepth depth = static_cast<ClipDepth>(seed % 3);
    Mat4 clip = withDepth(clipFromScene(view), depth);
    if (chance(random)) {
      // The two matrices of a program, in single precision.
      View camera = view;
      camera.eye = {};
      setOrientation(camera, {0, 0, -1}, {0, 1, 0});
      const Mat4 projection = inSinglePrecision(withDepth(clipFromScene(camera), depth));
      clip = projection * inSinglePrecision(lookAt(view));
    }
    const Result<View> found = viewFromClip(clip, {.depth = depth});
    ASSERT_TRUE(found) << "seed " << seed << ": " << found.error().message;
    const Frustum frustum = frustumOf(*found);
    for (int i = 0; i < 200; ++i) {
      // A point beside one of the planes.
      const double along = view.z_near * std::exp(random.in(-1.0, 8.0));
      Vec3d point = found->eye + found->forward * along + random.point(along);
      const std::size_t plane = static_cast<std::size_t>(random.in(0.0, 6.0));
      const double reach = length(point - found->eye) + length(found->eye);
      point = point - frustum.planes[plane].normal *
                          (frustum.planes[plane].evaluate(point) -
                           random.in(-1.0, 1.0) * std::exp2(random.in(-42.0, 0.0)) * reach);
      const double distance = frustum.planes[plane].evaluate(point);
      const double allowed = 1e-12 * (length(point - found->eye) + length(found->eye)) +
                             (plane == 5 && !orthographic
                                  ? 1e-15 * (found->z_far + length(found->eye)) / found->z_near * found->z_far
                                  : 0.0);
      if (std::abs(distance) > allowed && std::isfinite(allowed)) {
        ++compared;
        EXPECT_EQ(margins(clip, depth, point)[plane] > 0.0L, distance > 0.0)
            << "seed " << seed << " plane " << plane << " distance " << distance << " of " << reach;
      }
    }
  }
  EXPECT_GT(compared, 100000);
}

// Rounding turns row z of a product in single precision by up to 1e-7, so that what it says far from the
// origin is of no use at the eye.
TEST(ViewFromClip, HasTheNearPlaneOfAMatrixOfSinglePrecisionFarFromTheOrigin) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    Random random(seed);
    View view;
    view.eye = random.point(5000.0);
    setOrientation(view, random.point(1.0), {0, 1, 0});
    view.tan_half_fovy = 0.7;
    view.aspect = 16.0 / 9.0;
    view.z_near = 0.1;
    view.z_far = 1000.0;
    const ClipDepth depth = static_cast<ClipDepth>(seed % 3);
    const Mat4 clip = inSinglePrecision(withDepth(clipFromScene(view), depth));
    const Result<View> found = viewFromClip(clip, {.depth = depth});
    ASSERT_TRUE(found) << "seed " << seed << ": " << found.error().message;
    // The matrix may tilt the near plane by 1e-6: that is so much at the border of the picture.
    const double allowed = 1e-6 * found->z_near + 1e-12 * length(found->eye);
    for (const double beyond : {-2.0 * allowed, 2.0 * allowed}) {
      const Vec3d point = found->eye + found->forward * (found->z_near + beyond);
      EXPECT_EQ(margins(clip, depth, point)[4] > 0.0L, beyond > 0.0) << "seed " << seed;
    }
  }
}

// The far plane of such a matrix is tilted: it is the difference of two rows that are nearly the same.
TEST(ViewFromClip, ShowsAllThatAMatrixOfSinglePrecisionShowsBeforeItsFarPlane) {
  std::size_t shown = 0;
  for (std::uint64_t seed = 1; seed <= 600; ++seed) {
    Random random(seed);
    View view;
    view.eye = random.point(100.0);
    setOrientation(view, random.point(1.0), {0, 1, 0});
    view.tan_half_fovy = 0.7;
    view.aspect = 16.0 / 9.0;
    view.z_near = 0.1;
    view.z_far = 0.1 * std::pow(10.0, 3 + static_cast<int>(seed % 4));
    const ClipDepth depth = seed % 2 == 0 ? ClipDepth::kMinusOneToOne : ClipDepth::kZeroToOne;
    const Mat4 clip = inSinglePrecision(withDepth(clipFromScene(view), depth));
    const Result<View> found = viewFromClip(clip, {.depth = depth});
    ASSERT_TRUE(found) << "seed " << seed << ": " << found.error().message;
    const double up = found->tan_half_fovy, right = up * found->aspect;
    for (int i = 0; i < 40; ++i) {
      const double x = random.in(-0.999, 0.999), y = random.in(-0.999, 0.999);
      const double distance = view.z_far * random.in(0.8, 1.2);
      const Vec3d point =
          found->eye + (found->forward + found->right * (x * right) + found->up * (y * up)) * distance;
      const auto margin = margins(clip, depth, point);
      if (margin[5] > 0.0L) {
        ++shown;
        EXPECT_LE(dot(point - found->eye, found->forward), found->z_far * (1.0 + 1e-6)) << "seed " << seed;
      }
    }
  }
  EXPECT_GT(shown, 5000u);
}

// ---- Errors.

void expectError(const Mat4& clip, const ClipSpace& space, const std::string& word) {
  const Result<View> view = viewFromClip(clip, space);
  ASSERT_FALSE(view) << word;
  EXPECT_NE(view.error().message.find(word), std::string::npos) << view.error().message;
}

TEST(ViewFromClip, RoundingInRowWMakesNoPerspective) {
  View view;
  setOrientation(view, {0, 0, -1}, {0, 1, 0});
  view.orthographic = true;
  view.ortho_height = 100.0;
  view.z_far = 100.0;
  for (const double noise : {1e-17, -1e-17, -3e-18, 1e-15}) {
    Mat4 clip = clipFromScene(view);
    clip(3, 2) = noise;
    const Result<View> found = viewFromClip(clip, {});
    ASSERT_TRUE(found) << found.error().message;
    EXPECT_TRUE(found->orthographic) << noise;
    EXPECT_NEAR(found->ortho_height, 100.0, 1e-9);
    EXPECT_NEAR(found->z_far, view.z_far - view.z_near, 1e-9);
  }
}

TEST(ViewFromClip, RefusesAnObliqueNearPlane) {
  Mat4 projection = glFrustum(kWindow);
  // E. Lengyel, Oblique View Frustum Depth Projection and Clipping, 2005: z becomes a clip plane minus w.
  projection(2, 0) = 0.3;
  projection(2, 1) = 0.2;
  projection(2, 2) = -0.9 + 1.0;
  projection(2, 3) = -0.5;
  expectError(projection * lookAt(someCamera()), {}, "oblique");
}

TEST(ViewFromClip, RefusesShearedProjections) {
  Mat4 cabinet = glOrtho(kWindow);
  cabinet(0, 2) = 0.5;  // what is farther is farther to the right
  expectError(cabinet * lookAt(someCamera()), {}, "sheared");
  for (Mat4 sheared : {glFrustum(kWindow), glOrtho(kWindow)}) {
    sheared(0, 1) = 0.1;
    expectError(sheared * lookAt(someCamera()), {}, "right angles");
  }
}

TEST(ViewFromClip, RefusesDepthsInAnotherOrder) {
  const Mat4 look = lookAt(someCamera());
  expectError(reversedInfinite(kWindow) * look, {.depth = ClipDepth::kZeroToOne}, "ClipSpace::depth");
  Mat4 direct3d = d3dOffCenterLeftHanded(kWindow) * scaling(1, 1, -1) * look;
  expectError(direct3d, {.depth = ClipDepth::kOneToZero}, "ClipSpace::depth");
  for (int column = 0; column < 4; ++column) {
    direct3d(2, column) = direct3d(3, column) - direct3d(2, column);
  }
  expectError(direct3d, {.depth = ClipDepth::kZeroToOne}, "ClipSpace::depth");
}

TEST(ViewFromClip, RefusesWhatIsNoProjection) {
  expectError(fromRows({}), {}, "row w");
  Mat4 negative = glOrtho(kWindow);
  negative(3, 3) = -1.0;
  expectError(negative, {}, "row w");
  Mat4 behind = glFrustum(kWindow);
  for (double& element : behind.m) {
    element = -element;
  }
  expectError(behind, {}, "in front of the eye");
  for (const int row : {0, 1}) {
    for (Mat4 flat : {glFrustum(kWindow), glOrtho(kWindow)}) {
      for (int column = 0; column < 4; ++column) {
        flat(row, column) = 0.0;
      }
      expectError(flat * lookAt(someCamera()), {}, "do not span space");
    }
  }
  Mat4 no_depth = glOrtho(kWindow);
  no_depth(2, 2) = 0.0;
  expectError(no_depth, {}, "depth range");
  Mat4 beside = glFrustum(kWindow);
  beside(0, 2) = 1001.0;
  expectError(beside, {}, "View::shift_x");
}

TEST(ViewFromClip, RefusesNumbersThatAreNotFinite) {
  for (std::size_t i = 0; i < 16; ++i) {
    for (const double bad : {kNotANumber, kEndless, -kEndless}) {
      Mat4 clip = glFrustum(kWindow) * lookAt(someCamera());
      clip.m[i] = bad;
      expectError(clip, {}, "finite");
    }
  }
  // Any numbers at all give a view that validate() accepts, or an error.
  for (std::uint64_t seed = 1; seed <= 20000; ++seed) {
    Random random(seed);
    Mat4 clip = chance(random) ? glFrustum(kWindow) : Mat4{};
    for (double& element : clip.m) {
      element = chance(random) ? element : random.in(-1, 1) * std::exp2(random.in(-1074.0, 1023.0));
    }
    const Result<View> view = viewFromClip(clip, {.depth = static_cast<ClipDepth>(seed % 3)});
    EXPECT_TRUE(!view || validate(*view)) << "seed " << seed;
  }
}

// Lengyel's matrix: the row of depths is replaced so that the near plane is any plane before the eye.
TEST(ViewFromClip, AnObliqueNearPlaneIsThePlaneThatItWasMadeOf) {
  Random random(31);
  for (int i = 0; i < 300; ++i) {
    View view;
    view.eye = random.point(50.0);
    setOrientation(view, random.point(1.0), random.point(1.0));
    view.shift_x = random.in(-0.5, 0.5);
    view.tan_half_fovy = random.in(0.2, 1.5);
    const Vec3d normal = normalized(view.forward + random.point(0.5));
    const Vec3d on = view.eye + view.forward * random.in(0.5, 20.0);
    const Plane plane{normal, -dot(normal, on)};
    const double size = random.in(0.1, 10.0);
    Mat4 matrix = clipFromScene(view);
    const bool gl = i % 2 == 0;
    for (int column = 0; column < 4; ++column) {
      const double p = size * (column < 3 ? plane.normal[column] : plane.offset);
      // z + w = p; or, of reversed depth, w - z = p.
      matrix(2, column) = gl ? p - matrix(3, column) : matrix(3, column) - p;
    }
    const ClipSpace space{.depth = gl ? ClipDepth::kMinusOneToOne : ClipDepth::kOneToZero};
    EXPECT_FALSE(viewFromClip(matrix, space));
    const Result<ObliqueView> oblique = obliqueViewFromClip(matrix, space);
    ASSERT_TRUE(oblique) << oblique.error().message;
    EXPECT_LT(length(oblique->near_plane.normal - plane.normal), 1e-12);
    EXPECT_NEAR(oblique->near_plane.offset, plane.offset, 1e-9);
    EXPECT_LT(length(oblique->view.eye - view.eye), 1e-9);
    EXPECT_LT(length(oblique->view.forward - view.forward), 1e-12);
    EXPECT_NEAR(oblique->view.shift_x, view.shift_x, 1e-12);
    EXPECT_EQ(oblique->view.z_far, kEndless);
    // No point of the picture is drawn that is nearer, and one of its corners hardly farther.
    double nearest = kEndless;
    for (int corner = 0; corner < 4; ++corner) {
      const double x = (corner & 1) != 0 ? 1.0 : -1.0, y = (corner & 2) != 0 ? 1.0 : -1.0;
      const Vec3d ray = view.forward + view.right * ((x + view.shift_x) * view.tan_half_fovy * view.aspect) +
                        view.up * ((y + view.shift_y) * view.tan_half_fovy);
      const double along = dot(normal, ray);
      nearest = along > 0.0 ? std::min(nearest, -plane.evaluate(view.eye) / along) : nearest;
    }
    EXPECT_LE(oblique->view.z_near, nearest);
    EXPECT_GE(oblique->view.z_near, nearest * (1.0 - 1e-6));
  }
}

TEST(ViewFromClip, ObliqueViewsHaveANearPlaneBeforeTheEye) {
  View view;
  view.right = {1, 0, 0}, view.up = {0, 1, 0}, view.forward = {0, 0, -1};
  Mat4 matrix = clipFromScene(view);
  EXPECT_TRUE(obliqueViewFromClip(matrix, {}));
  matrix(0, 0) = kNotANumber;
  EXPECT_FALSE(obliqueViewFromClip(matrix, {}));
  EXPECT_FALSE(obliqueViewFromClip(Mat4(), {}));
  EXPECT_FALSE(obliqueViewFromClip(Mat4{{}}, {}));
  // All of the picture is behind the plane z = 5.
  matrix = clipFromScene(view);
  matrix(2, 3) = -5.0;
  for (int column = 0; column < 3; ++column) {
    matrix(2, column) = (column == 2 ? 1.0 : 0.0) - matrix(3, column);
  }
  EXPECT_FALSE(obliqueViewFromClip(matrix, {}));
}

// The near plane of a matrix that is read with the depths of another convention is not where it was.
TEST(ViewFromClip, RefusesAMatrixWhoseNearPlaneIsElsewhereThanTold) {
  const Mat4 clip = glFrustum(kWindow) * lookAt(someCamera());
  const auto depthIs = [&](ClipDepth depth, double z_near) {
    return viewFromClip(clip, {.depth = depth, .z_near = z_near});
  };
  EXPECT_TRUE(depthIs(ClipDepth::kMinusOneToOne, kWindow.near));
  EXPECT_TRUE(depthIs(ClipDepth::kMinusOneToOne, 0.995 * kWindow.near));
  EXPECT_TRUE(depthIs(ClipDepth::kZeroToOne, 0.0)) << "nothing is told";
  const Result<View> other = depthIs(ClipDepth::kZeroToOne, kWindow.near);
  ASSERT_FALSE(other);
  EXPECT_NE(other.error().message.find("is ClipSpace::depth that of the matrix?"), std::string::npos);
  EXPECT_FALSE(depthIs(ClipDepth::kMinusOneToOne, 1.02 * kWindow.near));
}

}  // namespace
}  // namespace sightline
