#pragma once

#include <array>
#include <cstdint>

#include "sightline/pvs/format/visibility_octree.h"

namespace sightline::pvs {

// Finds the leaf of a viewpoint, from the leaf found before. Cells hold their lower borders; the last ones
// along an axis hold the upper border of the root too.
//
// The borders on the path from the root to the last leaf are kept as gridLine gives them, so that a viewpoint
// is only ever compared with the very numbers that the baker used.
class CellFinder {
 public:
  static constexpr std::uint32_t kOutside = 0xffffffffu;

  // A checked octree, which must outlive it.
  explicit CellFinder(const OctreeView& octree);

  // The index of the leaf, or kOutside.
  std::uint32_t find(const Vec3d& eye) {
    return leaf_ != kOutside && path_[level_].holds(eye) ? leaf_ : search(eye);
  }
  // Of the leaf found last.
  OctreeCell cell() const { return {level_, path_[level_].at}; }

 private:
  struct Step {
    Vec3d min, max;  // the cell holds [min, max)
    std::uint32_t node = 0;
    std::array<std::uint32_t, 3> at{};

    // false for what is not a number. All six are compared: jumps between them would be hard to foresee.
    bool holds(const Vec3d& eye) const {
      return (eye.x >= min.x) & (eye.x < max.x) & (eye.y >= min.y) & (eye.y < max.y) & (eye.z >= min.z) &
             (eye.z < max.z);
    }
  };

  std::uint32_t search(const Vec3d& eye);
  void stepDown(OctreeLink first_child, const Vec3d& eye);

  OctreeView octree_;
  std::array<Step, kMaxOctreeDepth + 1> path_;  // from the root to the last leaf
  std::uint32_t level_ = 0;
  std::uint32_t leaf_ = kOutside;
};

}  // namespace sightline::pvs
