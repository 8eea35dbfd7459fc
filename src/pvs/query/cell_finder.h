#pragma once

#include <array>
#include <cstdint>

#include "sightline/pvs/format/visibility_octree.h"

namespace sightline::pvs {

// Finds the leaf of a viewpoint, starting from the leaf found before. Cells include their lower borders; the
// last cells along an axis also include the upper border of the root.
//
// Stores the borders on the path from the root to the last leaf as gridLine returns them, so that a viewpoint
// is compared with exactly the numbers that the baker used.
class CellFinder {
 public:
  static constexpr std::uint32_t kOutside = 0xffffffffu;

  // octree: checked; it must outlive this.
  explicit CellFinder(const OctreeView& octree);

  // Returns the index of the leaf, or kOutside.
  std::uint32_t find(const Vec3d& eye) {
    return leaf_ != kOutside && path_[level_].holds(eye) ? leaf_ : search(eye);
  }
  // True if viewers are expected at this place of the cell found last.
  bool expects(const Vec3d& eye) const {
    return !partly_ || ((eye.x >= viewers_min_.x) & (eye.x <= viewers_max_.x) & (eye.y >= viewers_min_.y) &
                        (eye.y <= viewers_max_.y) & (eye.z >= viewers_min_.z) & (eye.z <= viewers_max_.z));
  }
  // The cell of the leaf found last.
  OctreeCell cell() const { return {level_, path_[level_].at}; }

 private:
  struct Step {
    Vec3d min, max;  // the cell is [min, max)
    std::uint32_t node = 0;
    std::array<std::uint32_t, 3> at{};

    // Returns false for NaN. Always compares all six coordinates, because branches between them would be
    // unpredictable.
    bool holds(const Vec3d& eye) const {
      return (eye.x >= min.x) & (eye.x < max.x) & (eye.y >= min.y) & (eye.y < max.y) & (eye.z >= min.z) &
             (eye.z < max.z);
    }
  };

  std::uint32_t search(const Vec3d& eye);
  void stepDown(OctreeLink first_child, const Vec3d& eye);
  void findViewers();

  OctreeView octree_;
  std::array<Step, kMaxOctreeDepth + 1> path_;  // from the root to the last leaf
  std::uint32_t level_ = 0;
  std::uint32_t leaf_ = kOutside;
  // Where in the last leaf's cell viewers are expected.
  bool partly_ = false;  // not in all of it
  Vec3d viewers_min_, viewers_max_;
};

}  // namespace sightline::pvs
