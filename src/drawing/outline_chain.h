#pragma once

// The border of many polygons of the same orientation, in integers.
//
// Two neighbours traverse a shared edge in opposite directions, so the two cancel. The edges that are left
// form loops, whose winding number at a point is the number of polygons that cover it. So the union of the
// polygons is where the winding number is not zero, and the loops have some hundred edges where the polygons
// had some hundred thousand.

#include <compare>
#include <cstdint>
#include <span>
#include <vector>

namespace sightline::drawing {

struct GridPoint {
  std::int64_t x = 0, y = 0;  // absolute values below 2^62

  friend auto operator<=>(const GridPoint&, const GridPoint&) = default;
};
using GridPath = std::vector<GridPoint>;  // a closed ring; the first corner is not repeated

// The sign of the ring's area: 1 if it turns from x towards y.
int orientationOf(std::span<const GridPoint> ring);
// The sign of the turn at b: 1 from x towards y.
int turnOf(const GridPoint& a, const GridPoint& b, const GridPoint& c);

class OutlineChain {
 public:
  void clear();
  // Adds the edges of a ring. Precondition: its orientation is positive.
  void add(std::span<const GridPoint> ring);
  // Takes out the edges that are left after cancelling, as closed loops without collinear corners; loops may
  // touch and cross. The chain is empty afterwards.
  void takeLoops(std::vector<GridPath>& loops);

 private:
  struct Edge {
    GridPoint a, b;  // a < b
    bool forward = true;
  };
  struct Step {
    GridPoint from, to;
  };
  void cancel();

  std::vector<Edge> edges_;
  std::vector<Step> steps_;  // ascending by `from`
  // For the first step of each point, the point's first step that may be unused.
  std::vector<std::size_t> next_;
};

}  // namespace sightline::drawing
