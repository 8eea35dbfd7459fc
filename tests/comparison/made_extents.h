#pragma once

// Seeded tables of moving extents, and a check of an ExtentTree against comparing all parts.

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

#include "src/comparison/layers/extent_tree.h"

namespace sightline::comparison::made {

using namespace layers;

inline constexpr float kInfinite = std::numeric_limits<float>::infinity();
using Random = std::mt19937;

inline std::uint32_t pick(Random& random, std::uint32_t count) {
  return static_cast<std::uint32_t>(random()) % count;
}

inline float uniform(Random& random, float low, float high) {
  return std::uniform_real_distribution<float>(low, high)(random);
}

inline ExtentTable makeTable(std::size_t parts, const std::vector<ExtentAxis::Kind>& kinds) {
  ExtentTable table;
  table.parts = parts;
  table.kinds = kinds;
  const std::size_t rows = parts + ExtentTable::kPadding;
  table.lows.assign(kinds.size(), std::vector<float>(rows, kInfinite));
  table.highs.assign(kinds.size(), std::vector<float>(rows, -kInfinite));
  return table;
}

inline void set(ExtentTable& table, std::size_t axis, std::size_t part, const Interval& interval) {
  table.lows[axis][part] = interval.low;
  table.highs[axis][part] = interval.high;
}

// Returns an angular interval in the form of a table: low in [-2, 2], high in [low, low + 4].
inline Interval angularInterval(float low, float width) {
  if (width >= 4.0f) {
    return {-2.0f, 2.0f};
  }
  while (low > 2.0f) {
    low -= 4.0f;
  }
  while (low < -2.0f) {
    low += 4.0f;
  }
  return {low, low + width};
}

// Returns a random interval, which now and then is a difficult case.
inline Interval anyInterval(Random& random, ExtentAxis::Kind kind, float width) {
  const unsigned sort = pick(random, 16);
  if (kind == ExtentAxis::Kind::kAngular) {
    const float low = sort == 0   ? -2.0f
                      : sort == 1 ? 2.0f
                      : sort == 2 ? std::nextafter(2.0f, 0.0f)
                                  : uniform(random, -2, 2);
    const float wide = sort == 3   ? 0.0f
                       : sort == 4 ? 4.0f
                       : sort == 5 ? 2.0f - low
                                   : width * uniform(random, 0, 2);
    return angularInterval(low, wide);
  }
  const float low = sort < 3 ? 0.25f * static_cast<float>(pick(random, 5)) : uniform(random, 0, 1);
  switch (sort) {
    case 0:
    case 3:
      return {low, low};
    case 1:
      return {low, low + 0.25f};
    case 4:
      return pick(random, 4) == 0 ? Interval{-kInfinite, low} : Interval{low, low + width};
    case 5:
      return pick(random, 4) == 0 ? Interval{low, kInfinite} : Interval{low, low + width};
    case 6:
      return pick(random, 8) == 0 ? Interval{-kInfinite, kInfinite} : Interval{-0.0f, 0.0f};
    default:
      return {low, low + width * uniform(random, 0, 2)};
  }
}

inline void scatter(ExtentTable& table, Random& random, float width) {
  for (std::size_t part = 0; part < table.parts; ++part) {
    for (std::size_t axis = 0; axis < table.axes(); ++axis) {
      set(table, axis, part, anyInterval(random, table.kinds[axis], width));
    }
  }
}

// Moves the parts. Most move by at most `step`, some only at one end; some stand still, and `jumps` of a
// hundred jump anywhere.
inline void move(ExtentTable& table, Random& random, float step, float width, unsigned jumps) {
  for (std::size_t part = 0; part < table.parts; ++part) {
    const unsigned lot = pick(random, 100);
    for (std::size_t axis = 0; axis < table.axes(); ++axis) {
      const Interval old = table.at(axis, static_cast<std::uint32_t>(part));
      const float by = uniform(random, -step, step);
      if (lot < jumps) {
        set(table, axis, part, anyInterval(random, table.kinds[axis], width));
      } else if (lot >= 90) {
        continue;
      } else if (table.angular(axis)) {
        const float wider = lot < 30 ? std::max(0.0f, old.high - old.low + by) : old.high - old.low;
        set(table, axis, part, angularInterval(lot < 20 ? old.low : old.low + by, wider));
      } else {
        const float low = lot < 20 ? old.low : old.low + by;
        set(table, axis, part, {low, std::max(low, lot < 30 ? old.high - by : old.high + by)});
      }
    }
  }
}

inline Extent anyQuery(const ExtentTable& table, Random& random, float width) {
  Extent query;
  const auto part = table.parts == 0 ? 0u : pick(random, static_cast<std::uint32_t>(table.parts));
  const bool is_own = table.parts > 0 && pick(random, 3) != 0;
  for (std::size_t axis = 0; axis < table.axes(); ++axis) {
    query[axis] = is_own ? table.at(axis, part) : anyInterval(random, table.kinds[axis], width);
    if (!table.angular(axis) && pick(random, 3) == 0) {
      query[axis].low = pick(random, 8) == 0 ? -kInfinite : std::min(query[axis].low, 0.0f);
    }
  }
  return query;
}

inline std::vector<std::uint32_t> byComparingAll(const ExtentTable& table, const Extent& query,
                                                 const std::vector<bool>& active) {
  std::vector<std::uint32_t> parts;
  for (std::uint32_t part = 0; part < table.parts; ++part) {
    if (active[part] && overlaps(table, query, part)) {
      parts.push_back(part);
    }
  }
  return parts;
}

inline std::vector<ExtentAxis::Kind> kindsOf(std::size_t axes, unsigned angular) {
  std::vector<ExtentAxis::Kind> kinds(axes, ExtentAxis::Kind::kSpatial);
  for (std::size_t axis = 0; axis < axes; ++axis) {
    if ((angular >> axis & 1u) != 0) {
      kinds[axis] = ExtentAxis::Kind::kAngular;
    }
  }
  return kinds;
}

// Divides the expected parts by the rule, from the root down, and expects the same parts in the tree's nodes.
inline void expectSubtree(const ExtentTree& tree, std::uint32_t index,
                          const std::vector<std::uint32_t>& expected, const std::vector<bool>& active) {
  const ExtentNodes::Node& node = tree.nodes().nodes()[index];
  const auto actives =
      std::count_if(expected.begin(), expected.end(), [&](std::uint32_t p) { return active[p]; });
  EXPECT_EQ(node.active, actives) << "node " << index;
  if (node.axis == ExtentNodes::kNone) {
    const auto span = tree.nodes().partsOfLeaf(index);
    std::vector<std::uint32_t> parts(span.begin(), span.end());
    std::sort(parts.begin(), parts.end());
    EXPECT_EQ(parts, expected) << "leaf " << index;
    return;
  }
  const auto lows = tree.nodes().lowsOf(index), highs = tree.nodes().highsOf(index);
  EXPECT_TRUE(std::is_sorted(lows.begin(), lows.end()));
  EXPECT_TRUE(std::is_sorted(highs.begin(), highs.end()));
  std::vector<std::uint32_t> of_lows, of_highs, left, right;
  for (std::size_t i = 0; i < lows.size(); ++i) {
    EXPECT_EQ(keyOf(lows[i]), tree.keys().lows[node.axis][partOf(lows[i])]);
    EXPECT_EQ(keyOf(highs[i]), tree.keys().highs[node.axis][partOf(highs[i])]);
    of_lows.push_back(partOf(lows[i]));
    of_highs.push_back(partOf(highs[i]));
  }
  std::sort(of_lows.begin(), of_lows.end());
  std::sort(of_highs.begin(), of_highs.end());
  EXPECT_EQ(of_lows, expected) << "node " << index;
  EXPECT_EQ(of_highs, expected) << "node " << index;
  for (const std::uint32_t part : expected) {
    if (tree.keys().lows[node.axis][part] <= node.value) {
      left.push_back(part);
    }
    if (tree.keys().highs[node.axis][part] > node.value) {
      right.push_back(part);
    }
  }
  expectSubtree(tree, node.left, left, active);
  expectSubtree(tree, node.left + 1, right, active);
}

// Expects each part in exactly the nodes to which the rule leads.
inline void expectSound(const ExtentTree& tree, const std::vector<bool>& active) {
  std::vector<std::uint32_t> all(active.size());
  for (std::uint32_t part = 0; part < all.size(); ++part) {
    all[part] = part;
  }
  expectSubtree(tree, 0, all, active);
}

struct Case {
  unsigned seed = 0;
  std::size_t parts = 100;
  std::vector<ExtentAxis::Kind> kinds;
  ExtentTreeSettings settings;
  float width = 0.1f, step = 0.01f;
  unsigned jumps = 0, frames = 12, queries = 40;
};

inline void expectAnswers(ExtentTree& tree, const ExtentTable& table, const Case& one, Random& random) {
  std::vector<bool> active(table.parts, true);
  std::vector<std::uint32_t> parts;
  for (unsigned i = 0; i < one.queries; ++i) {
    for (unsigned change = 0; change < 5 && table.parts > 0; ++change) {
      const auto part = pick(random, static_cast<std::uint32_t>(table.parts));
      active[part] = pick(random, 4) == 0;
      tree.setActive(part, active[part]);
    }
    const Extent query = anyQuery(table, random, one.width);
    parts.assign(1, 77);  // query() must append
    tree.query(query, parts);
    ASSERT_EQ(parts.front(), 77u);
    parts.erase(parts.begin());
    ASSERT_EQ(parts, byComparingAll(table, query, active)) << "seed " << one.seed << " query " << i;
  }
  expectSound(tree, active);
}

}  // namespace sightline::comparison::made
