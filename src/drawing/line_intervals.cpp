#include "src/drawing/line_intervals.h"

#include <algorithm>
#include <iterator>

namespace sightline::drawing {

void LineIntervals::add(double from, double to) {
  const auto first = std::partition_point(intervals_.begin(), intervals_.end(),
                                          [from](const Interval& i) { return i.to < from; });
  const auto last =
      std::partition_point(first, intervals_.end(), [to](const Interval& i) { return i.from <= to; });
  if (first == last) {
    intervals_.insert(first, {from, to});
    return;
  }
  *first = {std::min(from, first->from), std::max(to, std::prev(last)->to)};
  intervals_.erase(std::next(first), last);
}

bool LineIntervals::covers(double from, double to) const {
  const auto first = std::partition_point(intervals_.begin(), intervals_.end(),
                                          [from](const Interval& i) { return i.to < from; });
  return first != intervals_.end() && first->from <= from && to <= first->to;
}

}  // namespace sightline::drawing
