#include "src/pvs/query/cell_finder.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sightline::pvs {
namespace {

// The smallest number beyond the root. Rounding may put the last grid line inside the box's border; no cell
// reaches farther than both.
double endOf(double min, double max) {
  return std::nextafter(std::min(max, gridLine(min, max, 0, 1)), std::numeric_limits<double>::infinity());
}

}  // namespace

CellFinder::CellFinder(const OctreeView& octree) : octree_(octree) {
  const Vec3d& min = octree.min;
  const Vec3d& max = octree.max;
  path_[0] = {min, {endOf(min.x, max.x), endOf(min.y, max.y), endOf(min.z, max.z)}, 0, {}};
}

// Steps from path_[level_] to the child that contains the viewpoint.
void CellFinder::stepDown(OctreeLink first_child, const Vec3d& eye) {
  const Step& step = path_[level_];
  Step& child = path_[++level_];
  child.node = first_child;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const std::uint32_t middle = step.at[a] * 2 + 1;
    const double line = gridLine(octree_.min[axis], octree_.max[axis], level_, middle);
    const std::uint32_t upper = eye[axis] >= line ? 1 : 0;
    // A table look-up instead of a branch, which would be unpredictable.
    const double lines[3] = {step.min[axis], line, step.max[axis]};
    child.min[axis] = lines[upper];
    child.max[axis] = lines[upper + 1];
    child.at[a] = step.at[a] * 2 + upper;
    child.node += upper << axis;
  }
}

std::uint32_t CellFinder::search(const Vec3d& eye) {
  // Go up to a cell that contains the viewpoint, then down.
  for (; !path_[level_].holds(eye); --level_) {
    if (level_ == 0) {
      return leaf_ = kOutside;
    }
  }
  OctreeLink link = octree_.nodes[path_[level_].node];
  while ((link & kOctreeLeaf) == 0) {
    stepDown(link, eye);
    link = octree_.nodes[path_[level_].node];
  }
  leaf_ = link & ~kOctreeLeaf;
  if (!octree_.viewers.empty()) {
    findViewers();
  }
  return leaf_;
}

void CellFinder::findViewers() {
  const ViewerBounds& viewers = octree_.viewers[leaf_];
  partly_ = viewers != ViewerBounds{};
  if (partly_) {
    viewers_min_ = viewersMin(octree_.min, octree_.max, cell(), viewers);
    viewers_max_ = viewersMax(octree_.min, octree_.max, cell(), viewers);
  }
}

}  // namespace sightline::pvs
