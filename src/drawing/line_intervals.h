#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace sightline::drawing {

// A closed set of numbers as ascending intervals that do not touch each other. Reuses its memory.
class LineIntervals {
 public:
  struct Interval {
    double from = 0.0, to = 0.0;
  };

  void clear() { intervals_.clear(); }
  // Adds [from, to] and joins it with the intervals that it touches. Precondition: from <= to.
  void add(double from, double to);
  // Whether all of [from, to] is in the set.
  bool covers(double from, double to) const;
  std::span<const Interval> intervals() const { return intervals_; }

 private:
  std::vector<Interval> intervals_;
};

}  // namespace sightline::drawing
