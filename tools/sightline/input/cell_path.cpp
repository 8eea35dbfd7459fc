#include "tools/sightline/input/cell_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>

#include "sightline/pvs/format/visibility_octree.h"

namespace sightline::tool {
namespace {

constexpr double kFovDeg = 90.0;
constexpr int kTries = 32;  // random points of a cell that are tried to find one at its plane

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  double in(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
  }
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(engine_() % n); }
  Vec3d direction() {
    for (;;) {
      const Vec3d d(in(-1, 1), in(-1, 1), in(-1, 1));
      const double l = length(d);
      if (l > 0.1 && l < 1.0) {
        return d / l;
      }
    }
  }

 private:
  std::mt19937_64 engine_;
};

struct CellBox {
  Vec3d min, max;
};

bool inside(const CellBox& cell, const Vec3d& p) {
  return p.x >= cell.min.x && p.y >= cell.min.y && p.z >= cell.min.z && p.x <= cell.max.x &&
         p.y <= cell.max.y && p.z <= cell.max.z;
}

Vec3d anywhere(const CellBox& cell, Random& random) {
  Vec3d p;
  for (int axis = 0; axis < 3; ++axis) {
    p[axis] = std::clamp(random.in(cell.min[axis], cell.max[axis]), cell.min[axis], cell.max[axis]);
  }
  return p;
}

// A point on this number of faces at once (0: anywhere in the cell), or a few ulps inside them.
Vec3d atBorder(const CellBox& cell, int faces, bool on_it, Random& random) {
  Vec3d p = anywhere(cell, random);
  const std::uint32_t first = random.below(3);
  for (int f = 0; f < faces; ++f) {
    const auto axis = static_cast<int>((first + static_cast<std::uint32_t>(f)) % 3);
    const bool upper = random.below(2) == 1;
    p[axis] = upper ? cell.max[axis] : cell.min[axis];
    for (std::uint32_t ulps = on_it ? 0 : 1 + random.below(3); ulps > 0; --ulps) {
      p[axis] = std::nextafter(p[axis], upper ? cell.min[axis] : cell.max[axis]);
    }
  }
  return p;
}

// A point of the cell whose dot product with the normal is at least `offset` (at_least) or at most, and as
// near to it as rounding allows. None if the cell does not reach there.
std::optional<Vec3d> atPlane(const CellBox& cell, const Vec3d& normal, double offset, bool at_least,
                             Random& random) {
  for (int i = 0; i < kTries; ++i) {
    Vec3d p = anywhere(cell, random);
    p += normal * (offset - dot(normal, p));
    const double step = 0x1p-52 * (std::abs(p.x) + std::abs(p.y) + std::abs(p.z) + std::abs(offset));
    for (int s = 0; s < 4 && (at_least ? dot(normal, p) < offset : dot(normal, p) > offset); ++s) {
      p += normal * (at_least ? step : -step);
    }
    if (inside(cell, p)) {
      return p;
    }
  }
  return std::nullopt;
}

// Every seventh cell gets a viewpoint anywhere in it, the others one at a border.
Vec3d viewpoint(std::uint32_t leaf, const CellBox& cell, Random& random) {
  const std::uint32_t turn = leaf % 7;
  return atBorder(cell, static_cast<int>((turn + 1) / 2), turn % 2 == 1, random);
}

double nearOf(const CameraPath& path, double near_distance) {
  View view = path.view(0, {});
  view.z_near = 1.0;
  // A little less, because of the rounding of nearDistance.
  const double near = near_distance / nearDistance(view) * (1.0 - 1e-9);
  return near > 0.0 ? near : path.z_near;
}

}  // namespace

CellPath cellPath(const SightFile& baked, const Scene& scene) {
  const OctreeView octree = baked.octree();
  std::vector<OctreeCell> cells(octree.leaves.size());
  forEachLeaf(octree, [&](std::uint32_t leaf, const OctreeCell& cell) { cells[leaf] = cell; });

  CellPath result;
  result.path.name = "cells";
  result.path.fovy_deg = kFovDeg;
  const auto add = [&](const Vec3d& eye, Random& random) {
    result.path.frames.push_back({eye + scene.origin, random.direction(), random.direction()});
    result.eyes.push_back(eye);
  };
  for (std::uint32_t leaf = 0; leaf < cells.size(); ++leaf) {
    Random random(leaf);
    const ViewerBounds viewers = octree.viewersOf(leaf);
    const CellBox cell{viewersMin(octree.min, octree.max, cells[leaf], viewers),
                       viewersMax(octree.min, octree.max, cells[leaf], viewers)};
    add(viewpoint(leaf, cell, random), random);
    if (octree.leaves[leaf].plane == OctreeLeaf::kNoPlane) {
      continue;
    }
    const CellPlane& plane = octree.planes[octree.leaves[leaf].plane];
    for (const bool front : {true, false}) {
      const double offset = front ? plane.front : plane.back;
      if (const auto eye = atPlane(cell, plane.normal, offset, front, random)) {
        add(*eye, random);
      }
    }
  }
  if (!result.path.frames.empty()) {
    result.path.z_near = nearOf(result.path, baked.record().near_distance);
  }
  const Box bounds = sceneBounds(scene.view());
  const double reach = length(Vec3d(bounds.max) - Vec3d(bounds.min)) + length(octree.max - octree.min) +
                       length(center(bounds) - (octree.min + octree.max) * 0.5);
  result.path.z_far = std::isfinite(reach) ? std::max(result.path.z_far, reach) : result.path.z_far;
  return result;
}

}  // namespace sightline::tool
