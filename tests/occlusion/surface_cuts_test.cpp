// What surfaces cover that the near plane cuts along an edge which is nearly parallel to it.

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "tests/occlusion/surface_proofs.h"
#include "tests/support/hand_made.h"
#include "tests/support/made_surfaces.h"
#include "tests/support/random_numbers.h"
#include "tests/support/rounds.h"

namespace sightline {
namespace {

using hand_made::frontView;
using test::drawAndProve;
using test::kDrawAll;
using test::ProvedPixels;
using test::provePixels;
using test::sceneOfCorners;

constexpr std::uint32_t kWidth = 64, kHeight = 48;
constexpr double kNear = 0.1;
constexpr double kClipDepth = kNear * (1.0 + 1e-6);  // where surfaces are cut

// A wall from an edge near the eye, upright at x = 0.02 and z = 0, into the distance on the left. Its
// triangles divide the edge at these heights, all on one line.
Scene wallFromEdge(const std::vector<float>& heights) {
  const Vec3f low(-50.0f, -60.0f, -30.0f), high(-50.0f, 60.0f, -30.0f);
  const auto at = [&](std::size_t i) { return Vec3f(0.02f, heights[i], 0.0f); };
  std::vector<Vec3f> corners;
  for (std::size_t i = 1; i < heights.size(); ++i) {
    corners.insert(corners.end(), {at(i - 1), at(i), low});
  }
  corners.insert(corners.end(), {at(heights.size() - 1), high, low});
  return sceneOfCorners(corners, true);
}

// The clip plane and the edge are parallel but for a tilt in the last bits, so rounding moves the point of
// the cut far along the edge, for the triangles' edges elsewhere than for the whole one.
TEST(SurfaceCuts, OfADividedEdgeCoverNothingBesideIt) {
  std::size_t covered = 0;
  for (const double tilt : {0.0, 1e-17, 4e-17, 1e-16, 2.4e-16, 1e-15, 1e-12}) {
    View view = frontView();
    view.z_near = kNear;
    view.forward = {0.0, tilt, -1.0};
    view.eye = {0.0, 0.0, kClipDepth};
    const ProvedPixels checked = drawAndProve(wallFromEdge({-0.03f, 0.0f, 0.06f}), view, kWidth, kHeight);
    EXPECT_TRUE(checked.right()) << "tilt " << tilt << ": " << checked.wrong << " of " << checked.covered;
    covered += checked.covered;
  }
  EXPECT_GT(covered, 2'000u) << "the wall hides what lies behind it";
}

// Every second wall is drawn through a matrix that mirrors it.
TEST(SurfaceCuts, OfEdgesDividedAtRandomCoverNothingBesideThem) {
  test::Random random(5);
  Mat4 mirror;
  mirror(0, 0) = -1.0;
  for (std::size_t n = 0; n < test::rounds(400u); ++n) {
    std::vector<float> heights{-0.0625f};
    while (heights.size() < 2 + n % 4) {
      heights.push_back(heights.back() + 0x1p-6f * static_cast<float>(1 + random.below(4)));
    }
    View view = frontView();
    view.z_near = kNear;
    view.forward = {0.0, random.in(-6e-16, 6e-16), -1.0};
    view.eye = {random.in(-0.01, 0.01), random.in(-0.02, 0.02),
                kClipDepth + 0x1p-56 * (static_cast<double>(random.below(9)) - 4.0)};
    Scene scene = wallFromEdge(heights);
    const SurfaceSet surfaces = findSurfaces(scene.view());
    Rasteriser raster({.width = kWidth, .height = kHeight});
    raster.begin(view);
    if (n % 2 == 0) {
      raster.draw(surfaces, surfaces.objects, kDrawAll);
    } else {
      raster.draw(MovingSurfaces{&surfaces, mirror}, kDrawAll);
      for (Vec3f& position : scene.positions) {
        position.x = -position.x;
      }
      updateBounds(scene);
    }
    const ProvedPixels checked = provePixels(scene, view, raster.depthBuffer());
    EXPECT_TRUE(checked.right()) << n << ": " << checked.wrong << " of " << checked.covered;
    EXPECT_GT(checked.covered, 500u) << n << ": the wall hides what lies behind it";
  }
}

}  // namespace
}  // namespace sightline
