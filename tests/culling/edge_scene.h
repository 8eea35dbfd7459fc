#pragma once

// Walls that end within a pixel of a picture, and boxes behind them, all placed by pixels.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/occluders/surface_set.h"
#include "src/scene/pixel_view.h"
#include "tests/occlusion/small_scenes.h"
#include "tests/support/hand_made.h"

namespace sightline::test {

// Where a wall covers a part of a pixel, a coarse depth buffer cannot tell whether a box behind it shows
// there. A finer one can.
struct EdgeScene {
  static constexpr std::uint32_t kWidth = 320, kHeight = 180;  // pixels
  static constexpr double kWallDepth = 10.0, kBoxDepth = 20.0;

  View view = viewFrom({0, 0, 0}, {0, 0, -1});

  explicit EdgeScene(bool orthographic = false) {
    view.aspect = double{kWidth} / kHeight;
    view.orthographic = orthographic;
    view.ortho_height = 20.0;
  }

  // Where a column of the picture is at a depth, metres.
  double xAt(double pixel, double depth) const {
    const scene::PixelView buffer(view, kWidth, kHeight);
    return (pixel - buffer.middle_x) / buffer.scale_x * (view.orthographic ? 1.0 : depth);
  }
  double yAt(double pixel, double depth) const {
    const scene::PixelView buffer(view, kWidth, kHeight);
    return (pixel - buffer.middle_y) / buffer.scale_y * (view.orthographic ? 1.0 : depth);
  }

  // A wall over the whole height of the picture, between two columns of pixels.
  OraclePolygon wallBetween(double left, double right, double depth = kWallDepth) const {
    return wallTo(xAt(left, depth), -depth, right, depth);
  }
  // A wall that begins behind the eye, far to its left, and ends at a column of pixels.
  OraclePolygon wallPastTheEye(double right) const { return wallTo(-100.0, 5.0, right, kWallDepth); }
  // A flat box that faces the eye.
  Box boxBetween(double left, double right, double bottom, double top) const {
    return {Vec3f(Vec3d(xAt(left, kBoxDepth), yAt(bottom, kBoxDepth), -kBoxDepth)),
            Vec3f(Vec3d(xAt(right, kBoxDepth), yAt(top, kBoxDepth), -kBoxDepth))};
  }

 private:
  OraclePolygon wallTo(double left_x, double left_z, double right, double depth) const {
    const double x = xAt(right, depth);
    return {{Vec3f(Vec3d(left_x, -100, left_z)), Vec3f(Vec3d(x, -100, -depth)), Vec3f(Vec3d(x, 100, -depth)),
             Vec3f(Vec3d(left_x, 100, left_z))},
            true};
  }
};

inline Box boundsOf(const OraclePolygon& polygon) {
  Box box;
  for (const Vec3f& corner : polygon.vertices) {
    box.extend(corner);
  }
  return box;
}

// The surfaces of polygons with four corners each; the objects are numbered as they are given.
inline SurfaceSet surfacesOf(std::span<const OraclePolygon> polygons) {
  Scene scene;
  const MaterialId material = hand_made::addMaterial(scene, Opacity::kOpaque, true);
  for (const OraclePolygon& polygon : polygons) {
    const std::vector<Vec3f>& v = polygon.vertices;
    const std::vector<Vec3f> corners{v[0], v[1], v[2], v[0], v[2], v[3]};
    hand_made::addTriangles(scene, material, corners);
  }
  return findSurfaces(scene.view());
}

}  // namespace sightline::test
