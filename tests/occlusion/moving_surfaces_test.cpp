// Surfaces that a matrix places, against exact proofs.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "tests/occlusion/surface_proofs.h"
#include "tests/support/hand_made.h"
#include "tests/support/made_surfaces.h"
#include "tests/support/random_numbers.h"
#include "tests/support/rounds.h"

namespace sightline {
namespace {

using hand_made::addMaterial;
using hand_made::addWall;
using hand_made::frontView;
using test::drawAndProve;
using test::kDrawAll;
using test::ProvedPixels;
using test::provePixels;
using test::sheet;

// A rotation and a translation.
Mat4 placement(const Vec3d& forward, const Vec3d& up, const Vec3d& origin) {
  View axes;
  setOrientation(axes, forward, up);
  Mat4 m;
  const Vec3d columns[] = {axes.right, axes.up, -axes.forward, origin};
  for (int column = 0; column < 4; ++column) {
    m(0, column) = columns[column].x;
    m(1, column) = columns[column].y;
    m(2, column) = columns[column].z;
  }
  return m;
}

TEST(MovingSurfaces, AreDrawnWithAffineMatricesOnly) {
  Scene scene;
  addWall(scene, addMaterial(scene, Opacity::kOpaque, true), 0.0f, -50.0f, 50.0f, -50.0f, 50.0f);
  const SurfaceSet surfaces = findSurfaces(scene.view());
  Rasteriser raster({.width = 16, .height = 16});
  const auto coveredWith = [&](const Mat4& m) {
    raster.begin(frontView());
    raster.draw(MovingSurfaces{&surfaces, m}, kDrawAll);
    std::size_t count = 0;
    for (std::uint32_t y = 0; y < 16; ++y) {
      for (std::uint32_t x = 0; x < 16; ++x) {
        count += raster.depthBuffer().covered(x, y) ? 1 : 0;
      }
    }
    return count;
  };
  const Mat4 rigid = placement({0.2, 0.1, -1.0}, {0.3, 1.0, 0.0}, {0.0, 0.0, -10.0});
  EXPECT_EQ(coveredWith(rigid), 256u);
  Mat4 scaled = rigid, mirrored = rigid, sheared = rigid, not_a_number = rigid, far = rigid, halved = rigid,
       projected = rigid, flat = rigid, thin = rigid, endless = rigid, tiny = rigid;
  for (int row = 0; row < 3; ++row) {
    scaled(row, 0) *= 100.0;
    mirrored(row, 0) *= -1.0;
    sheared(row, 0) += 0.5 * rigid(row, 1);
    flat(row, 1) = 0.0;
    thin(row, 1) *= 1e-5;
    endless(row, 1) = std::numeric_limits<double>::infinity();
    for (int column = 0; column < 3; ++column) {
      tiny(row, column) *= 1e-30;
    }
  }
  not_a_number(1, 3) = std::numeric_limits<double>::quiet_NaN();
  far(0, 3) = 1e18;
  halved(3, 3) = 0.5;
  projected(3, 2) = std::numeric_limits<double>::quiet_NaN();
  for (const Mat4& m : {scaled, mirrored, sheared}) {
    EXPECT_EQ(coveredWith(m), 256u);
  }
  for (const Mat4& m : {not_a_number, far, halved, projected, flat, thin, endless, tiny}) {
    EXPECT_EQ(coveredWith(m), 0u);
  }
  raster.begin(frontView());
  raster.draw(MovingSurfaces{}, kDrawAll);
  EXPECT_FALSE(raster.depthBuffer().covered(8, 8));
}

// A wall that is turned about the vertical axis, and the view that looks at it along its normal.
struct TurnedWall {
  SurfaceSet surfaces;
  Mat4 scene_from_surfaces;
  View view;
  long double depth = 0.0L;  // of the wall, exactly

  // far: where the wall is along its normal, metres. before: how far the eye is before it, but for rounding.
  TurnedWall(float far, double before, double angle) {
    const float wide = 65536.0f;
    const std::array<Vec3f, 6> corners{Vec3f(far, -wide, -wide), Vec3f(far, wide, -wide),
                                       Vec3f(far, wide, wide),   Vec3f(far, -wide, -wide),
                                       Vec3f(far, wide, wide),   Vec3f(far, -wide, wide)};
    surfaces = findSurfaces(sceneOfCorners(corners, true).view());
    const double cosine = std::cos(angle), sine = std::sin(angle);
    scene_from_surfaces(0, 0) = scene_from_surfaces(1, 1) = cosine;
    scene_from_surfaces(0, 1) = -sine;
    scene_from_surfaces(1, 0) = sine;
    view = frontView();
    view.forward = {cosine, sine, 0.0};
    view.right = {sine, -cosine, 0.0};
    view.up = {0.0, 0.0, 1.0};
    view.eye = view.forward * (double{far} - before);
    const auto along = [&](double direction, double eye) {
      const auto exact = static_cast<long double>(direction);
      return exact * (exact * static_cast<long double>(far) - static_cast<long double>(eye));
    };
    depth = along(cosine, view.eye.x) + along(sine, view.eye.y);
  }
};

// The picture is one pixel and shows almost all directions, so that what moves a wall across the near plane
// moves its image by next to nothing.
TEST(MovingSurfaces, HideNothingThatRoundingMovesBeyondTheNearPlane) {
  constexpr long double kNear = 0.1L;
  Rasteriser raster({.width = 1, .height = 1});
  test::Random random(1);
  for (const bool orthographic : {false, true}) {
    for (const float far : {1e9f, 1e3f}) {
      std::size_t before_the_plane = 0, covered = 0;
      for (std::size_t n = 0; n < test::rounds(2'000u); ++n) {
        TurnedWall wall(far, 0.1 + random.in(-3e-7, 3e-7), random.in(0.1, 1.4));
        wall.view.tan_half_fovy = 13.0;
        wall.view.orthographic = orthographic;
        wall.view.ortho_height = 8.0;
        wall.view.z_near = static_cast<double>(kNear);
        raster.begin(wall.view);
        raster.draw(MovingSurfaces{&wall.surfaces, wall.scene_from_surfaces}, kDrawAll);
        const bool covers = raster.depthBuffer().covered(0, 0);
        covered += covers ? 1 : 0;
        if (wall.depth < kNear * (1.0L - 1e-9L)) {
          ++before_the_plane;
          EXPECT_FALSE(covers) << "a renderer clips the wall away; " << far << ", " << orthographic;
        }
      }
      EXPECT_GT(before_the_plane, test::rounds(500u));
      EXPECT_TRUE(far > 1e6f || covered > test::rounds(200u)) << orthographic;
    }
  }
}

class RandomMovingSurfaces : public testing::TestWithParam<bool> {};

// The view that sees the moved surfaces where they are before they are moved.
View movedBack(const View& view, const Mat4& m) {
  const auto turned = [&](const Vec3d& v) {
    return Vec3d(m(0, 0) * v.x + m(1, 0) * v.y + m(2, 0) * v.z, m(0, 1) * v.x + m(1, 1) * v.y + m(2, 1) * v.z,
                 m(0, 2) * v.x + m(1, 2) * v.y + m(2, 2) * v.z);
  };
  View back = view;
  back.eye = turned(view.eye - Vec3d(m(0, 3), m(1, 3), m(2, 3)));
  back.right = turned(view.right);
  back.up = turned(view.up);
  back.forward = turned(view.forward);
  return back;
}

TEST_P(RandomMovingSurfaces, HideWhatTheyCoverWhereverTheyAreMoved) {
  std::size_t covered = 0;
  Rasteriser raster({.width = 24, .height = 24});
  for (std::uint64_t seed = 0; seed < test::rounds(30u); ++seed) {
    std::mt19937 engine(static_cast<std::mt19937::result_type>(seed));
    const auto number = test::numbersFrom<double>(engine);
    const auto anywhere = [&](double size) {
      return Vec3d(number(-size, size), number(-size, size), number(-size, size));
    };
    const Scene scene = sheet(
        6, 40.0f, 12.0f, [&](float x, float y) { return 2.0f * std::sin(0.3f * x) * std::cos(0.4f * y); },
        [&](std::uint32_t) { return number(0.0, 1.0) < 0.05; });
    const SurfaceSet surfaces = findSurfaces(scene.view(), {.part_triangles = 30});
    const Mat4 m = placement(anywhere(1.0), anywhere(1.0), anywhere(seed % 3 == 0 ? 1e5 : 50.0));
    View view = frontView();
    view.orthographic = GetParam();
    view.ortho_height = 20.0;
    view.eye = transformPoint(m, anywhere(4.0));
    setOrientation(view, transformDirection(m, Vec3d(0.0, 0.0, -1.0) + anywhere(0.6)), anywhere(1.0));
    raster.begin(view);
    raster.draw(MovingSurfaces{&surfaces, m}, kDrawAll);
    const ProvedPixels checked = provePixels(scene, movedBack(view, m), raster.depthBuffer());
    EXPECT_TRUE(checked.right()) << "seed " << seed;
    covered += checked.covered;
  }
  EXPECT_GT(covered, test::rounds(3000u));
}

// The scene with each point where the matrix takes it, and the fronts of triangles still fronts. Exact if all
// coordinates and elements have few binary digits.
Scene transformed(Scene scene, const Mat4& m) {
  for (Vec3f& p : scene.positions) {
    p = Vec3f(transformPoint(m, Vec3d(p)));
  }
  for (std::size_t i = 0; determinant3(m) < 0.0 && i < scene.indices.size(); i += 3) {
    std::swap(scene.indices[i], scene.indices[i + 1]);
  }
  updateBounds(scene);
  return scene;
}

TEST_P(RandomMovingSurfaces, HideWhatTheyCoverHoweverTheyAreStretchedAndMirrored) {
  std::size_t covered = 0, of_the_transformed = 0, mirrored = 0;
  Rasteriser raster({.width = 24, .height = 24});
  for (std::uint64_t seed = 0; seed < test::rounds(40u); ++seed) {
    std::mt19937 engine(static_cast<std::mt19937::result_type>(seed));
    const auto number = test::numbersFrom<double>(engine);
    // Numbers of few binary digits, so that transformed points are exact in single precision.
    const auto eighths = [&](double size) { return std::floor(8.0 * number(-size, size)) / 8.0; };
    Scene scene = sheet(
        6, 40.0f, 12.0f,
        [&](float x, float y) {
          return std::round(32.0f * 2.0f * std::sin(0.3f * x) * std::cos(0.4f * y)) / 32.0f;
        },
        [&](std::uint32_t) { return number(0.0, 1.0) < 0.05; });
    for (Vec3f& p : scene.positions) {
      p = {std::round(32.0f * p.x) / 32.0f, std::round(32.0f * p.y) / 32.0f, std::round(32.0f * p.z) / 32.0f};
    }
    updateBounds(scene);
    Mat4 m;
    do {
      for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
          m(row, column) = seed % 4 == 0 ? (row == column ? (row == 2 ? 0.125 : 4.0) : 0.0) : eighths(2.0);
        }
        m(row, 3) = eighths(20.0);
      }
      if (seed % 8 == 0) {
        m(0, 0) = -m(0, 0);
      }
    } while (std::abs(determinant3(m)) < 0.2);
    mirrored += determinant3(m) < 0.0 ? 1 : 0;
    const SurfaceSet surfaces = findSurfaces(scene.view(), {.part_triangles = 30});
    const Scene world = transformed(scene, m);
    View view = frontView();
    view.orthographic = GetParam();
    view.ortho_height = 20.0;
    view.z_near = seed % 3 == 0 ? 3.0 : view.z_near;
    view.eye = transformPoint(m, {eighths(4.0), eighths(4.0), 0.0});
    setOrientation(view, transformDirection(m, Vec3d(eighths(0.5), eighths(0.5), -1.0)),
                   {number(-1.0, 1.0), number(-1.0, 1.0), number(-1.0, 1.0)});
    raster.begin(view);
    raster.draw(MovingSurfaces{&surfaces, m}, kDrawAll);
    const ProvedPixels checked = provePixels(world, view, raster.depthBuffer());
    EXPECT_TRUE(checked.right()) << "seed " << seed;
    covered += checked.covered;
    of_the_transformed += drawAndProve(world, view, 24, 24, {.part_triangles = 30}).covered;
  }
  EXPECT_GT(mirrored, test::rounds(10u));
  EXPECT_GT(covered, test::rounds(3000u));
  EXPECT_GT(static_cast<double>(covered), 0.9 * static_cast<double>(of_the_transformed));
}

INSTANTIATE_TEST_SUITE_P(Views, RandomMovingSurfaces, testing::Bool(),
                         [](const auto& shown) { return shown.param ? "Orthographic" : "Perspective"; });

}  // namespace
}  // namespace sightline
