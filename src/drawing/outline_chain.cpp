#include "src/drawing/outline_chain.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace sightline::drawing {
namespace {

__extension__ using Wide = __int128;

int signOf(Wide value) {
  return (value > 0) - (value < 0);
}

Wide crossOf(const GridPoint& origin, const GridPoint& a, const GridPoint& b) {
  return Wide(a.x - origin.x) * (b.y - origin.y) - Wide(a.y - origin.y) * (b.x - origin.x);
}

// Drops corners on the straight line between their neighbours, and spikes that go back on themselves.
void dropCollinear(GridPath& ring) {
  GridPath kept;
  for (const GridPoint& p : ring) {
    while (kept.size() >= 2 && turnOf(kept[kept.size() - 2], kept.back(), p) == 0) {
      kept.pop_back();
    }
    if (kept.empty() || kept.back() != p) {
      kept.push_back(p);
    }
  }
  // Do the same where the ring closes.
  std::size_t first = 0;
  while (kept.size() - first >= 3) {
    if (turnOf(kept[kept.size() - 2], kept.back(), kept[first]) == 0) {
      kept.pop_back();
    } else if (turnOf(kept.back(), kept[first], kept[first + 1]) == 0) {
      ++first;
    } else {
      break;
    }
  }
  kept.erase(kept.begin(), kept.begin() + static_cast<std::ptrdiff_t>(first));
  ring = std::move(kept);
}

}  // namespace

int turnOf(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
  return signOf(crossOf(a, b, c));
}

int orientationOf(std::span<const GridPoint> ring) {
  Wide area = 0;
  for (std::size_t i = 2; i < ring.size(); ++i) {
    area += crossOf(ring[0], ring[i - 1], ring[i]);
  }
  return signOf(area);
}

void OutlineChain::clear() {
  edges_.clear();
}

void OutlineChain::add(std::span<const GridPoint> ring) {
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const GridPoint& a = ring[i];
    const GridPoint& b = ring[i + 1 < ring.size() ? i + 1 : 0];
    if (a != b) {
      edges_.push_back({std::min(a, b), std::max(a, b), a < b});
    }
  }
}

// Cancels opposite steps: for each edge, as many remain as it is used more often in one direction than in the
// other.
void OutlineChain::cancel() {
  std::sort(edges_.begin(), edges_.end(),
            [](const Edge& s, const Edge& t) { return std::tie(s.a, s.b) < std::tie(t.a, t.b); });
  steps_.clear();
  for (std::size_t i = 0; i < edges_.size();) {
    const Edge& edge = edges_[i];
    std::int64_t balance = 0;
    for (; i < edges_.size() && edges_[i].a == edge.a && edges_[i].b == edge.b; ++i) {
      balance += edges_[i].forward ? 1 : -1;
    }
    const Step step = balance > 0 ? Step{edge.a, edge.b} : Step{edge.b, edge.a};
    steps_.insert(steps_.end(), static_cast<std::size_t>(std::abs(balance)), step);
  }
  std::sort(steps_.begin(), steps_.end(),
            [](const Step& s, const Step& t) { return std::tie(s.from, s.to) < std::tie(t.from, t.to); });
}

// The steps are what is left of closed rings, so as many leave each point as arrive there. Following unused
// steps therefore ends at the point where it began.
void OutlineChain::takeLoops(std::vector<GridPath>& loops) {
  cancel();
  edges_.clear();
  loops.clear();
  const auto firstAt = [&](const GridPoint& p) {
    return static_cast<std::size_t>(
        std::lower_bound(steps_.begin(), steps_.end(), p,
                         [](const Step& step, const GridPoint& q) { return step.from < q; }) -
        steps_.begin());
  };
  // If i is the first step of its point, next_[i] is the point's first unused step.
  next_.resize(steps_.size());
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    next_[i] = i;
  }
  for (std::size_t first = 0; first < steps_.size(); ++first) {
    const std::size_t group =
        first > 0 && steps_[first - 1].from == steps_[first].from ? firstAt(steps_[first].from) : first;
    if (next_[group] > first) {
      continue;  // used
    }
    GridPath loop;
    std::size_t at = group;
    do {
      const Step& step = steps_[next_[at]++];
      loop.push_back(step.from);
      at = firstAt(step.to);
    } while (at != group);
    dropCollinear(loop);
    if (loop.size() >= 3) {
      loops.push_back(std::move(loop));
    }
  }
}

}  // namespace sightline::drawing
