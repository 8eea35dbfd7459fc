#pragma once

// How far the edges of surfaces are swept over a depth buffer as the eye moves through a ViewerRegion. See
// "Several viewers" in docs/conservative.md.

#include <cstddef>
#include <vector>

#include "sightline/math/vec3.h"
#include "src/occlusion/surfaces/boundary_edge.h"
#include "src/scene/pixel_view.h"

namespace sightline::occlusion {

// Points in camera space, by coordinate.
struct CameraPoints {
  std::vector<double> x{}, y{}, z{};

  void reserve(std::size_t count) { makeRoomInLanes(count, {&x, &y, &z}); }
  Vec3d point(std::size_t i) const { return {x[i], y[i], z[i]}; }
  void set(std::size_t i, const Vec3d& point) {
    x[i] = point.x;
    y[i] = point.y;
    z[i] = point.z;
  }
};

// Lines from one point to another.
struct CameraLines {
  CameraPoints from{}, to{};

  void reserve(std::size_t count) {
    from.reserve(count);
    to.reserve(count);
  }
  void set(std::size_t i, const Vec3d& begin, const Vec3d& end) {
    from.set(i, begin);
    to.set(i, end);
  }
};

// Sets the sweeps of the first `count` lines, whose ends are not nearer than clip_depth. grid: the lines'
// images. Sweeps that do not come into the buffer are 0; those of a line that some viewer may pass are
// infinite, to one side at least.
void findSweeps(const scene::PixelView& view, double clip_depth, const CameraLines& lines,
                const GridLines& grid, std::size_t count, GridSweeps& sweeps);

}  // namespace sightline::occlusion
