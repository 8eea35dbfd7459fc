#pragma once

// Finds boxes that lines of sight from a point to a box may meet, many at a time, in single precision.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "src/pvs/bake/cell_region.h"

namespace sightline::pvs {

// The convex hull of a point, or of a box, and another box: at the place t of all lines from 0 at the first
// to 1 in the second, it is a box as well. From a point to a box without extent, a line of sight.
class Cone {
 public:
  // margin: how close boxes may come without being left out, metres. magnitude: bound of all coordinates.
  Cone(const Vec3d& point, const CellBox& box, double margin, double magnitude)
      : Cone(CellBox{point, point}, box, margin, magnitude) {}
  Cone(const CellBox& from, const CellBox& to, double margin, double magnitude);

  // Along an axis, a box from min to max is met at those t between 0 and 1 for which
  // min - low <= t * (how far the upper end moves) and max - high >= t * (how far the lower end moves), from
  // the first box to the second. Each is a bound of t, and both ways are given as their inverses.
  struct Axis {
    float low = 0.0f, high = 0.0f, inverse_far = 0.0f, inverse_near = 0.0f;
  };
  std::array<Axis, 3> axes{};
};

// Boxes, their coordinates side by side, and a number for each.
struct BoxLanes {
  std::array<std::vector<float>, 3> min{}, max{};  // by axis; padded for vectors
  std::vector<std::uint32_t> number;

  std::size_t size() const { return number.size(); }
  Box boxAt(std::size_t i) const {
    return {{min[0][i], min[1][i], min[2][i]}, {max[0][i], max[1][i], max[2][i]}};
  }
  void clear();
  void add(const Box& box, std::uint32_t its_number);
  // Adds boxes of others.
  void add(const BoxLanes& from, std::span<const std::uint32_t> places);
  // To be called after the last add().
  void pad();
};

// Sets `places` to those of the boxes that all of the cones meet, and of some that they almost do, ascending;
// the same on every instruction set.
void placesMet(const BoxLanes& boxes, std::span<const Cone> cones, std::vector<std::uint32_t>& places);

// Looks at the boxes first ... first + count - 1 alone.
void placesMet(const BoxLanes& boxes, std::size_t first, std::size_t count, std::span<const Cone> cones,
               std::vector<std::uint32_t>& places);

// A tree of boxes. Immutable.
class ConeTree {
 public:
  ConeTree() = default;
  // numbers: by box.
  ConeTree(std::span<const Box> boxes, std::span<const std::uint32_t> numbers);

  // Sets `found` to the places in boxes() of those that all cones meet, and of some that they almost do.
  // False, with nothing of use in `found`, if they are more than `most`.
  bool find(std::span<const Cone> cones, std::size_t most, std::vector<std::uint32_t>& found) const;

  // All boxes, with their numbers, and the boxes of nodes among them.
  const BoxLanes& boxes() const { return children_; }

 private:
  struct Node {
    std::uint32_t first_child = 0, child_count = 0;
  };
  bool findBelow(std::span<const Cone> cones, std::uint32_t node, std::size_t most,
                 std::vector<std::uint32_t>& found) const;

  std::vector<Node> nodes_;  // node 0 is the root
  BoxLanes children_;        // of all nodes, those of a node side by side: a node with the top bit, or a box
};

}  // namespace sightline::pvs
