#pragma once

// The border of many polygons that are oriented alike, in whole numbers.
//
// Where two neighbours share an edge, one goes along it forwards and the other backwards: the two cancel.
// What is left closes to loops, around which every point has the winding number that all polygons together
// give it: how many of them cover it. So the union of the polygons is where the loops' winding number is not
// zero, and the loops have some hundred edges where the polygons had some hundred thousand.

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

// Sign of the ring's area: 1 from x towards y.
int orientationOf(std::span<const GridPoint> ring);
// Of the turn at b.
int turnOf(const GridPoint& a, const GridPoint& b, const GridPoint& c);

class OutlineChain {
 public:
  void clear();
  // Edges of a ring. Rings are of positive orientation.
  void add(std::span<const GridPoint> ring);
  // What is left after edges have cancelled, as closed loops without collinear corners. They may touch and
  // cross. The chain is empty afterwards.
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
  std::vector<Step> steps_;        // ascending by `from`
  std::vector<std::size_t> next_;  // of each step: the first at its `from` that may be unused
};

}  // namespace sightline::drawing
