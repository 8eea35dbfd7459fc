#pragma once

// Finds boxes that lines of sight from a point to a box may meet, many at a time, in single precision.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "src/pvs/bake/cell_region.h"

namespace sightline::pvs {

// The convex hull of a point and a box: at the place t of all lines, from 0 at the point to 1 in the box, it
// is a box as well. With a box without extent, a line of sight.
class Cone {
 public:
  // margin: how close boxes may come without being left out, metres. magnitude: bound of all coordinates.
  Cone(const Vec3d& point, const CellBox& box, double margin, double magnitude);

  // Along an axis, a box from min to max is met at those t between 0 and 1 for which
  // min - low <= t * (the far end of the cone) and max - high >= t * (the near end). Each is a bound of t,
  // and both ends are given as their inverses.
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
