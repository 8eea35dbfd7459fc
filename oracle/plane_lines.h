#pragma once

// Free lines in a plane: a line from one segment to another that crosses none of many others.
//
// Every line is y = slope * x + height, directed along +x. Lines through a point of the plane are a straight
// line of the plane of (slope, height), so the lines that cross a segment in one direction are a wedge of it:
// above the one line, below the other. The lines from segment to segment are therefore a convex polygon, from
// which the wedges of what blocks them are subtracted, until a line is left or nothing. So a gap between two
// segments is found however narrow it is, down to rounding, and so is a line through several gaps in a row.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace sightline {

struct PlanePoint {
  double x = 0.0, y = 0.0;
};

// The part of a convex outline where `value`, a linear function of the point, is not negative.
template <typename Value>
std::vector<PlanePoint> clippedWhere(std::span<const PlanePoint> outline, Value&& value) {
  std::vector<PlanePoint> kept;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const PlanePoint &p = outline[i], &q = outline[(i + 1) % outline.size()];
    const double at_p = value(p), at_q = value(q);
    if (at_p >= 0.0) {
      kept.push_back(p);
    }
    if ((at_p > 0.0 && at_q < 0.0) || (at_p < 0.0 && at_q > 0.0)) {
      const double s = at_p / (at_p - at_q);
      kept.push_back({p.x + (q.x - p.x) * s, p.y + (q.y - p.y) * s});
    }
  }
  return kept;
}

// A segment that is crossed by lines with `left` on their left and `right` on their right.
struct Gate {
  PlanePoint left, right;
};

struct PlaneLine {
  double slope = 0.0, height = 0.0;

  // How far the point is to the left of the line; its sign is what matters.
  double leftOf(const PlanePoint& p) const { return p.y - slope * p.x - height; }
  // x where the line crosses the gate.
  double crossing(const Gate& gate) const;
  bool crosses(const Gate& gate) const { return leftOf(gate.left) >= 0.0 && leftOf(gate.right) <= 0.0; }
  PlanePoint at(double x) const { return {x, slope * x + height}; }
};

// Not for several threads at once.
class PlaneLines {
 public:
  // Called with lines that nothing blocks; true ends the search.
  using Accept = std::function<bool(const PlaneLine&)>;

  // Searches for a line that crosses `from` and then `to`, and between the two none of `blockers`. Returns
  // true if one was accepted. Gives up after max_steps lines.
  bool search(const Gate& from, const Gate& to, std::span<const Gate> blockers, std::uint32_t max_steps,
              const Accept& accept);

  // What the last search found: the line that the fewest blockers block, how many they are, and how many
  // lines it tried.
  const PlaneLine& best() const { return best_; }
  std::uint32_t bestBlocked() const { return best_blocked_; }
  std::uint32_t steps() const { return steps_; }

 private:
  using Piece = std::vector<PlanePoint>;  // x is a slope, y a height

  bool wide(const Piece& piece) const;
  // The blocker on this line that blocks the most of the piece; null if there is none.
  const Gate* blockerOn(const PlaneLine& line, const Piece& piece);
  void subtract(const Piece& piece, const Gate& gate);

  Gate from_, to_;
  std::span<const Gate> blockers_;
  std::vector<Piece> pieces_;  // lines of which it is not known yet whether they are blocked
  double min_width_ = 0.0;
  PlaneLine best_;
  std::uint32_t best_blocked_ = 0, blocked_ = 0, steps_ = 0;
};

}  // namespace sightline
