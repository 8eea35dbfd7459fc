#pragma once

// The grid points of a viewpoint database, and the search for the nearest of them.

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/math/box.h"
#include "src/base/byte_stream.h"
#include "src/occluders/database/database_bytes.h"

namespace sightline::comparison {

struct PointGrid {
  std::vector<Vec3d> points;  // at least one
  double spacing = 0.0;       // metres
};

// The grid points near viewpoints, or of a whole box: see ViewpointDatabase::build. There are at most
// max_points (> 0). bounds: of the scene; empty or broken bounds count as a box without extent at the origin.
// spacing: in metres; chosen where it is not finite or not positive.
PointGrid makeGrid(const Box& bounds, std::span<const Vec3d> viewpoints, double spacing,
                   std::uint32_t max_points);

// A kd-tree that finds the nearest of some points. Does not change once it is made.
class PointTree {
 public:
  PointTree() = default;
  explicit PointTree(std::span<const Vec3d> points);

  // The index of the nearest point, of equally near ones the first. 0 for a place that is not finite, or so
  // far away that all points are equally near. Precondition: there is a point.
  std::uint32_t nearest(const Vec3d& place) const;
  std::size_t bytes() const { return nodes_.capacity() * sizeof(Node); }  // beside the object itself

 private:
  // The middle node of a range is its root. Nodes with a smaller or equal coordinate lie before it.
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

// The places of a viewpoint database: grid points, and the search tree of them.
class GridPoints {
 public:
  static constexpr occluders::DatabaseKind kKind{"viewpoint database", "vptd", "points"};
  static std::uint32_t maxCount(std::uint32_t directions);

  GridPoints() = default;
  explicit GridPoints(PointGrid grid) : grid_(std::move(grid)), tree_(grid_.points) {}

  std::uint32_t count() const { return static_cast<std::uint32_t>(grid_.points.size()); }
  std::span<const Vec3d> points() const { return grid_.points; }
  double spacing() const { return grid_.spacing; }  // metres
  std::uint32_t nearest(const Vec3d& place) const { return tree_.nearest(place); }
  std::size_t bytes() const { return grid_.points.capacity() * sizeof(Vec3d) + tree_.bytes(); }

  // The spacing, then x, y and z of each point, all of 64 bits.
  void save(base::ByteWriter& writer) const;
  // So many points; refused where one is not finite.
  static Result<GridPoints> load(base::ByteReader& reader, std::uint32_t points);

 private:
  PointGrid grid_;
  PointTree tree_;
};

}  // namespace sightline::comparison
