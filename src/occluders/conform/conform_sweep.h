#pragma once

// Triangulates a planar figure by a sweep.
//
// Based on: S. Hertel and K. Mehlhorn. Fast triangulation of simple polygons. Fundamentals of Computation
// Theory, 1983. Differs from the paper in that the figure is any set of straight edges that meet only at
// their ends, with loose ends and single points inside, whose outline is a triangle.
//
// The points are swept in their order. Between two edges that the sweep crosses, one above the other, lies a
// slab with a chain of points, from the lower edge's first point to the upper one's: to the left of the chain
// all is triangulated, and no triangle can be added there without a new point. A new point sees the last
// point of the chain, and from there on all up to the first that it does not lie strictly outside of.
//
// What a face of the figure is divided into follows from the face alone: the triangles are the same in every
// figure that has it.

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <span>
#include <utility>
#include <vector>

namespace sightline::occluders {

class PlaneSweep {
 public:
  struct Edge {
    std::uint32_t low = 0, high = 0;  // points, low < high
    friend auto operator<=>(const Edge&, const Edge&) = default;
  };

  // Appends three points for each triangle, counter-clockwise. Points are numbers below `count`, in the order
  // of the sweep: by one coordinate, then by the other. edges: ascending; among them the outline. turn(a, b,
  // c) is positive if a, b, c run counter-clockwise.
  template <typename Turn>
  void triangulate(std::uint32_t count, std::span<const Edge> edges, const Turn& turn,
                   std::vector<std::uint32_t>& triangles);

 private:
  using Chain = std::vector<std::uint32_t>;  // from the bottom to the top
  struct Crossed {
    Edge edge;
    Chain above;  // of the slab between this edge and the next one; empty above the highest edge
  };

  template <typename Turn>
  void cutDown(Chain& chain, std::size_t from, std::uint32_t point, const Turn& turn,
               std::vector<std::uint32_t>& triangles);
  template <typename Turn>
  void cutUp(Chain& chain, std::size_t from, std::uint32_t point, const Turn& turn,
             std::vector<std::uint32_t>& triangles);
  template <typename Turn>
  std::size_t slabOf(std::uint32_t point, const Turn& turn) const;

  std::vector<Crossed> crossed_;  // by the sweep, from the bottom to the top
  std::vector<Crossed> leaving_;
};

// Leaves of a chain what is below a place in it, less what the point closes, with the point on top.
template <typename Turn>
void PlaneSweep::cutDown(Chain& chain, std::size_t from, std::uint32_t point, const Turn& turn,
                         std::vector<std::uint32_t>& triangles) {
  for (; from > 0 && turn(chain[from - 1], point, chain[from]) > 0; --from) {
    triangles.insert(triangles.end(), {chain[from - 1], point, chain[from]});
  }
  chain.resize(from + 1);
  chain.push_back(point);
}

// Likewise above, with the point at the bottom.
template <typename Turn>
void PlaneSweep::cutUp(Chain& chain, std::size_t from, std::uint32_t point, const Turn& turn,
                       std::vector<std::uint32_t>& triangles) {
  for (; from + 1 < chain.size() && turn(chain[from], point, chain[from + 1]) > 0; ++from) {
    triangles.insert(triangles.end(), {chain[from], point, chain[from + 1]});
  }
  if (from > 0) {
    chain.erase(chain.begin() + 1, chain.begin() + static_cast<std::ptrdiff_t>(from));
    chain[0] = point;
  } else {
    chain.insert(chain.begin(), point);
  }
}

// The highest crossed edge that lies below a point at which none ends.
template <typename Turn>
std::size_t PlaneSweep::slabOf(std::uint32_t point, const Turn& turn) const {
  std::size_t below = 0, above = crossed_.size() - 1;  // the outline is below and above
  while (above - below > 1) {
    const std::size_t middle = (below + above) / 2;
    (turn(crossed_[middle].edge.low, crossed_[middle].edge.high, point) > 0 ? below : above) = middle;
  }
  return below;
}

template <typename Turn>
void PlaneSweep::triangulate(std::uint32_t count, std::span<const Edge> edges, const Turn& turn,
                             std::vector<std::uint32_t>& triangles) {
  crossed_.clear();
  std::size_t next_edge = 0;
  for (std::uint32_t point = 0; point < count; ++point) {
    leaving_.clear();
    for (; next_edge < edges.size() && edges[next_edge].low == point; ++next_edge) {
      leaving_.push_back({edges[next_edge], {point}});
    }
    std::sort(leaving_.begin(), leaving_.end(),
              [&](const Crossed& a, const Crossed& b) { return turn(point, a.edge.high, b.edge.high) > 0; });
    std::size_t first = 0;
    while (first < crossed_.size() && crossed_[first].edge.high != point) {
      ++first;
    }
    std::size_t end = first;
    while (end < crossed_.size() && crossed_[end].edge.high == point) {
      ++end;
    }
    Chain lower, upper;  // of the slabs below and above the point, as far as they are
    if (first < end) {
      if (first > 0) {
        lower = std::move(crossed_[first - 1].above);
        cutDown(lower, lower.size() - 1, point, turn, triangles);
      }
      for (std::size_t i = first; i + 1 < end; ++i) {
        const Chain& chain = crossed_[i].above;
        for (std::size_t k = 0; k + 1 < chain.size(); ++k) {
          triangles.insert(triangles.end(), {chain[k], point, chain[k + 1]});
        }
      }
      if (end < crossed_.size()) {
        upper = std::move(crossed_[end - 1].above);
        cutUp(upper, 0, point, turn, triangles);
      }
    } else if (!crossed_.empty()) {
      first = end = slabOf(point, turn) + 1;
      lower = std::move(crossed_[first - 1].above);
      const auto last =
          static_cast<std::size_t>(std::max_element(lower.begin(), lower.end()) - lower.begin());
      upper.assign(lower.begin() + static_cast<std::ptrdiff_t>(last), lower.end());
      cutDown(lower, last, point, turn, triangles);
      cutUp(upper, 0, point, turn, triangles);
    }
    if (leaving_.empty()) {
      if (!lower.empty() && !upper.empty()) {
        lower.insert(lower.end(), upper.begin() + 1, upper.end());
      }
    } else {
      leaving_.back().above = std::move(upper);
    }
    if (first > 0) {
      crossed_[first - 1].above = std::move(lower);
    }
    const auto begin = crossed_.begin() + static_cast<std::ptrdiff_t>(first);
    crossed_.erase(begin, crossed_.begin() + static_cast<std::ptrdiff_t>(end));
    crossed_.insert(crossed_.begin() + static_cast<std::ptrdiff_t>(first),
                    std::make_move_iterator(leaving_.begin()), std::make_move_iterator(leaving_.end()));
  }
}

}  // namespace sightline::occluders
