#pragma once

// Exact proofs of what a depth buffer of surfaces promises: whatever lies in a covered pixel farther than its
// depth is hidden.

#include <array>
#include <cstdint>
#include <vector>

#include "oracle/exact_visibility.h"
#include "sightline/occluders/surface_set.h"
#include "sightline/occlusion/rasteriser.h"
#include "tests/support/hand_made.h"

namespace sightline::test {

// Adds a see-through quad that fills pixel (x, y) of the view at this depth, farther by 10^-5 of it.
inline ObjectId addPixel(Scene& scene, MaterialId glass, const View& view, std::uint32_t width,
                         std::uint32_t height, std::uint32_t x, std::uint32_t y, double depth) {
  depth *= 1.0 + 1e-5;
  const auto corner = [&](std::uint32_t column, std::uint32_t row) {
    // A thousandth of a pixel inside: corners are rounded to single precision.
    const double inset_x = column == x ? 1e-3 : -1e-3, inset_y = row == y ? 1e-3 : -1e-3;
    const double u = 2.0 * (column + inset_x) / width - 1.0, v = 2.0 * (row + inset_y) / height - 1.0;
    const double half = view.orthographic ? 0.5 * view.ortho_height : depth * view.tan_half_fovy;
    return Vec3f(view.eye + view.forward * depth + view.right * (u * half * view.aspect) +
                 view.up * (v * half));
  };
  const Vec3f a = corner(x, y), b = corner(x + 1, y), c = corner(x + 1, y + 1), d = corner(x, y + 1);
  return hand_made::addTriangles(scene, glass, std::array<Vec3f, 6>{a, b, c, a, c, d});
}

struct ProvedPixels {
  std::size_t covered = 0, wrong = 0, undecided = 0;

  bool right() const { return wrong + undecided == 0; }
};

inline constexpr SurfaceDrawing kDrawAll{
    .limits = {.min_pixels = 0.0, .min_patch_pixels = 0.0, .pixels_per_edge = 0.0}};

// Proves for each covered pixel, or for every so many of them, that what lies behind it is hidden.
inline ProvedPixels provePixels(const Scene& scene, const View& view, const DepthBufferView& buffer,
                                std::size_t every = 1) {
  Scene with_pixels = scene;
  const MaterialId glass = hand_made::addMaterial(with_pixels, Opacity::kBlended, true);
  std::vector<ObjectId> pixels;
  ProvedPixels checked;
  for (std::uint32_t y = 0; y < buffer.height; ++y) {
    for (std::uint32_t x = 0; x < buffer.width; ++x) {
      if (!buffer.covered(x, y) || checked.covered++ % every != 0) {
        continue;
      }
      const double value = buffer.at(x, y), depth = view.orthographic ? -value : 1.0 / value;
      if (depth < view.z_far / 1.1) {
        pixels.push_back(addPixel(with_pixels, glass, view, buffer.width, buffer.height, x, y, depth));
      }
    }
  }
  for (const Decision& decision : ExactVisibility(with_pixels.view()).decide(view, pixels, 20'000)) {
    checked.wrong += decision.verdict == Verdict::kVisible ? 1 : 0;
    checked.undecided += decision.verdict == Verdict::kUndecided ? 1 : 0;
  }
  return checked;
}

inline ProvedPixels drawAndProve(const Scene& scene, const View& view, std::uint32_t width,
                                 std::uint32_t height, const SurfaceSettings& settings = {},
                                 const SurfaceDrawing& drawing = kDrawAll) {
  Rasteriser raster({.width = width, .height = height});
  raster.begin(view);
  const SurfaceSet surfaces = findSurfaces(scene.view(), settings);
  raster.draw(surfaces, surfaces.objects, drawing);
  return provePixels(scene, view, raster.depthBuffer());
}

}  // namespace sightline::test
