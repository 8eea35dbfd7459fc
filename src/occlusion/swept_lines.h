#pragma once

// How far the edges of surfaces are swept over a depth buffer as the eye moves through a ViewerRegion. See
// "Several viewers" in docs/conservative.md.

#include <cstddef>
#include <vector>

#include "sightline/math/vec3.h"
#include "src/occlusion/boundary_edge.h"
#include "src/scene/pixel_view.h"

namespace sightline::occlusion {

// Where the coordinates of some points of a list begin.
struct CameraPlaces {
  double *x = nullptr, *y = nullptr, *z = nullptr;
};

// Points in camera space, by coordinate.
struct CameraPoints {
  std::vector<double> x{}, y{}, z{};

  CameraPlaces at(std::size_t i) { return {x.data() + i, y.data() + i, z.data() + i}; }
  Vec3d point(std::size_t i) const { return {x[i], y[i], z[i]}; }
  void set(std::size_t i, const Vec3d& point) {
    x[i] = point.x;
    y[i] = point.y;
    z[i] = point.z;
  }
};

// Lines from one point to another.
struct SweptLines {
  CameraPoints from{}, to{};

  // Makes room for so many.
  void reserve(std::size_t count) {
    if (from.x.size() < count + kMostLanes) {
      for (CameraPoints* points : {&from, &to}) {
        for (std::vector<double>* list : {&points->x, &points->y, &points->z}) {
          list->resize(2 * count + kMostLanes);
        }
      }
    }
  }
  void set(std::size_t i, const Vec3d& begin, const Vec3d& end) {
    from.set(i, begin);
    to.set(i, end);
  }
};

// Sets the sweeps of the first `count` lines, whose ends are not nearer than clip_depth. Those of a line that
// no viewer sees in the buffer, as the eye's lines of sight go, are 0; those of one that some viewer may pass
// are larger than the buffer.
void findSweeps(const PixelView& view, double clip_depth, const SweptLines& lines, std::size_t count,
                GridSweeps& sweeps);

}  // namespace sightline::occlusion
