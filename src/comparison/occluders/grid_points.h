#pragma once

// The points of a grid that an occluder database is made for, and which of them is the nearest.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/math/box.h"
#include "src/base/byte_stream.h"

namespace sightline::comparison {

struct PointGrid {
  std::vector<Vec3d> points;  // at least one
  double spacing = 0.0;       // metres
};

// The grid points near viewpoints, or of a whole box, as ViewpointDatabase::build has it: at most max_points
// (> 0). bounds: of the scene; empty or broken: a box without extent at the origin. spacing: not finite or
// not positive: chosen.
PointGrid makeGrid(const Box& bounds, std::span<const Vec3d> viewpoints, double spacing,
                   std::uint32_t max_points);

// The spacing, then x, y, z of each point (64 bits each).
void saveGrid(ByteWriter& writer, const PointGrid& grid);
// So many points, all finite.
Result<PointGrid> loadGrid(ByteReader& reader, std::uint32_t points);

// Finds the nearest of some points. Does not change once it is made.
class PointTree {
 public:
  PointTree() = default;
  explicit PointTree(std::span<const Vec3d> points);

  // Of equally near ones the first; 0 for a place that is not finite, or so far away that all are equally
  // near. At least one point.
  std::uint32_t nearest(const Vec3d& place) const;
  std::size_t bytes() const { return nodes_.capacity() * sizeof(Node); }  // beside the object itself

 private:
  // The middle one of a range is its root: those with a smaller coordinate, or an equal one, lie before it.
  struct Node {
    Vec3d point;
    std::uint32_t index = 0;
    std::uint32_t axis = 0;
  };
  struct Best {
    double squared = 0.0;
    std::uint32_t index = 0;
  };
  void split(std::size_t begin, std::size_t end);
  void search(std::size_t begin, std::size_t end, const Vec3d& place, Best& best) const;

  std::vector<Node> nodes_;
};

}  // namespace sightline::comparison
