#include "src/layers/extents/extent_scan.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/layers/extents/extent_scan.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::layers::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Lanes = hn::CappedTag<std::uint8_t, ScanRows::kFanOut>;
using Mask = hn::Mask<Lanes>;

// The intervals, in cells, with which an axis is compared: the query and, on an angular axis, the query
// shifted by a turn in either direction if that can overlap anything.
struct AxisQuery {
  std::uint32_t shifts;
  std::uint8_t low[3], high[3];

  void add(const CellScale& scale, const Interval& interval) {
    low[shifts] = scale.cell(interval.low);
    high[shifts++] = scale.cell(interval.high);
  }
};

HWY_INLINE void setQuery(const ScanRows& rows, std::size_t axis, const Interval& query, AxisQuery& result) {
  result.shifts = 0;
  result.add(rows.scales[axis], query);
  if (rows.kinds[axis] == ExtentAxis::Kind::kAngular) {
    for (const float turn : {4.0f, -4.0f}) {
      const Interval shifted{query.low + turn, query.high + turn};
      if (overlapsSpatial(shifted, rows.all[axis])) {
        result.add(rows.scales[axis], shifted);
      }
    }
  }
}

// Compares low <= query.high and high >= query.low for a vector of rows.
HWY_INLINE Mask overlap(const AxisQuery& query, const std::uint8_t* low, const std::uint8_t* high) {
  const Lanes d;
  const auto lows = hn::LoadU(d, low), highs = hn::LoadU(d, high);
  const auto within = [&](std::uint32_t i) HWY_ATTR {
    return hn::And(hn::Eq(hn::Max(highs, hn::Set(d, query.low[i])), highs),
                   hn::Eq(hn::Min(lows, hn::Set(d, query.high[i])), lows));
  };
  Mask any = within(0);
  for (std::uint32_t i = 1; HWY_UNLIKELY(i < query.shifts); ++i) {
    any = hn::Or(any, within(i));
  }
  return any;
}

struct Scan {
  Scan(const ScanRows& all, std::uint32_t* first) : rows(all), found(first) {}

  const ScanRows& rows;
  std::uint32_t* found;      // where the next row that overlaps is written
  std::uint64_t blocks = 0;  // number of blocks of kFanOut rows compared
  AxisQuery axes[kMaxExtentAxes];

  // Returns a bit for each of kFanOut rows of a level: whether its cells overlap along all axes.
  HWY_INLINE std::uint64_t overlapBits(std::size_t level, std::size_t first) const {
    const Lanes d;
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < ScanRows::kFanOut; i += hn::Lanes(d)) {
      const std::size_t at = rows.first[level] + first + i;
      Mask mask = hn::FirstN(d, ScanRows::kFanOut);
      for (std::size_t axis = 0; axis < rows.axes(); ++axis) {
        const std::size_t place = axis * rows.stride + at;
        mask = hn::And(mask, overlap(axes[axis], rows.lows.data() + place, rows.highs.data() + place));
        if (axis != 0 && hn::AllFalse(d, mask)) {
          break;
        }
      }
      std::uint8_t bytes[ScanRows::kFanOut / 8] = {};
      hn::StoreMaskBits(d, mask, bytes);
      std::uint64_t word = 0;
      std::memcpy(&word, bytes, sizeof(word));
      bits |= word << i;
    }
    return bits;
  }

  // Appends the overlapping rows of level 0 below a block.
  void visit(std::size_t level, std::size_t first) {
    std::uint64_t there = level == 0 ? rows.active[first / ScanRows::kFanOut] : ~std::uint64_t{0};
    if (level != 0 && rows.count[level] - first < ScanRows::kFanOut) {
      there = (std::uint64_t{1} << (rows.count[level] - first)) - 1;
    }
    if (there == 0) {
      return;
    }
    ++blocks;
    for (std::uint64_t bits = there & overlapBits(level, first); bits != 0; bits &= bits - 1) {
      const std::size_t row = first + static_cast<std::size_t>(std::countr_zero(bits));
      if (level == 0) {
        *found++ = static_cast<std::uint32_t>(row);
      } else {
        visit(level - 1, row * ScanRows::kFanOut);
      }
    }
  }
};

// Writes the overlapping rows to `found`, which has room for all, and returns the end of what was written.
std::uint32_t* scan(const ScanRows& rows, const Extent& query, std::uint32_t* found, std::uint64_t& blocks) {
  Scan scan(rows, found);
  for (std::size_t axis = 0; axis < rows.axes(); ++axis) {
    setQuery(rows, axis, query[axis], scan.axes[axis]);
  }
  scan.visit(rows.levels - 1, 0);
  blocks += scan.blocks;
  return scan.found;
}

}  // namespace sightline::layers::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::layers {

HWY_EXPORT(scan);

namespace {

constexpr std::size_t kFanOut = ScanRows::kFanOut;
constexpr Interval kNothing{std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()};
constexpr std::size_t kMaxClusterAxes = 3;

// The axes by which parts are clustered: angular axes if there are any, since a query reaches to the eye
// along the others.
struct ClusterAxes {
  std::array<std::size_t, kMaxClusterAxes> axis{};
  std::size_t count = 0;
};

ClusterAxes clusterAxes(const ExtentTable& table) {
  ClusterAxes chosen;
  const bool any_angular = std::any_of(table.kinds.begin(), table.kinds.end(), [](ExtentAxis::Kind kind) {
    return kind == ExtentAxis::Kind::kAngular;
  });
  for (std::size_t axis = 0; axis < table.axes() && chosen.count < kMaxClusterAxes; ++axis) {
    if (table.angular(axis) || !any_angular) {
      chosen.axis[chosen.count++] = axis;
    }
  }
  return chosen;
}

// Spreads the bits of a cell's number, with two zero bits between neighbours, for a Morton code.
std::uint32_t spread(std::uint32_t cell) {
  std::uint32_t x = cell;
  x = (x | x << 8) & 0x0300f00fu;
  x = (x | x << 4) & 0x030c30c3u;
  return (x | x << 2) & 0x09249249u;
}

}  // namespace

void ExtentScan::beginFrame(const ExtentTable& table, std::span<const std::uint32_t> order) {
  table_ = &table;
  measure(order);
  cluster(order);
  layOut();
  fillRows();
  uniteRows();
  found_.resize(order.size());
  rows_.active.assign((order.size() + kFanOut - 1) / kFanOut, ~std::uint64_t{0});
  if (order.size() % kFanOut != 0) {
    rows_.active.back() = (std::uint64_t{1} << (order.size() % kFanOut)) - 1;
  }
}

// Divides each axis into 256 cells from the smallest finite bound to the greatest.
void ExtentScan::measure(std::span<const std::uint32_t> order) {
  rows_.kinds = table_->kinds;
  for (std::size_t axis = 0; axis < rows_.axes(); ++axis) {
    Interval all = kNothing, finite = kNothing;
    for (const std::uint32_t part : order) {
      const Interval own = table_->at(axis, part);
      all = unite(all, own);
      finite.low = std::isfinite(own.low) ? std::min(finite.low, own.low) : finite.low;
      finite.high = std::isfinite(own.high) ? std::max(finite.high, own.high) : finite.high;
    }
    const float width = finite.high - finite.low;
    rows_.all[axis] = all;
    rows_.scales[axis] = {finite.low, width > 0.0f && std::isfinite(width) ? 256.0f / width : 0.0f};
  }
}

// Orders the parts along a Morton curve through the middles of their intervals.
void ExtentScan::cluster(std::span<const std::uint32_t> order) {
  const ClusterAxes axes = clusterAxes(*table_);
  keys_.clear();
  for (const std::uint32_t part : order) {
    std::uint32_t key = 0;
    for (std::size_t i = 0; i < axes.count; ++i) {
      const Interval own = table_->at(axes.axis[i], part);
      key |= spread(rows_.scales[axes.axis[i]].cell(0.5f * (own.low + own.high))) << i;
    }
    keys_.push_back(std::uint64_t{key} << 32 | part);
  }
  std::sort(keys_.begin(), keys_.end());
  place_.assign(table_->parts, kNowhere);
  part_.clear();
  for (const std::uint64_t key : keys_) {
    const auto part = static_cast<std::uint32_t>(key);
    place_[part] = static_cast<std::uint32_t>(part_.size());
    part_.push_back(part);
  }
}

void ExtentScan::layOut() {
  rows_.levels = 0;
  rows_.stride = 0;
  for (std::size_t count = part_.size();; count = (count + kFanOut - 1) / kFanOut) {
    rows_.count[rows_.levels] = count;
    rows_.first[rows_.levels++] = rows_.stride;
    rows_.stride += (count + kFanOut - 1) / kFanOut * kFanOut;
    if (count <= kFanOut) {
      break;
    }
  }
  rows_.lows.resize(rows_.axes() * rows_.stride);
  rows_.highs.resize(rows_.axes() * rows_.stride);
}

void ExtentScan::fillRows() {
  for (std::size_t axis = 0; axis < rows_.axes(); ++axis) {
    const CellScale scale = rows_.scales[axis];
    for (std::size_t i = 0; i < part_.size(); ++i) {
      const Interval own = table_->at(axis, part_[i]);
      rows_.lows[axis * rows_.stride + i] = scale.cell(own.low);
      rows_.highs[axis * rows_.stride + i] = scale.cell(own.high);
    }
  }
}

// Unites angles as numbers on a line: a query that overlaps a row after a shift by a turn then overlaps the
// union, too.
void ExtentScan::uniteRows() {
  for (std::size_t axis = 0; axis < rows_.axes(); ++axis) {
    std::uint8_t *const lows = rows_.lows.data() + axis * rows_.stride, *const highs = rows_.highs.data() +
                                                                                       axis * rows_.stride;
    for (std::size_t level = 1; level < rows_.levels; ++level) {
      const std::size_t below = rows_.first[level - 1], here = rows_.first[level];
      for (std::size_t i = 0; i < rows_.count[level]; ++i) {
        const std::size_t begin = below + i * kFanOut,
                          end = below + std::min((i + 1) * kFanOut, rows_.count[level - 1]);
        lows[here + i] = *std::min_element(lows + begin, lows + end);
        highs[here + i] = *std::max_element(highs + begin, highs + end);
      }
    }
  }
}

void ExtentScan::setActive(std::uint32_t part, bool active) {
  const std::uint32_t place = place_[part];
  if (place == kNowhere) {
    return;
  }
  const std::uint64_t bit = std::uint64_t{1} << (place % kFanOut);
  std::uint64_t& word = rows_.active[place / kFanOut];
  word = active ? word | bit : word & ~bit;
}

void ExtentScan::query(const Extent& query, std::vector<std::uint32_t>& parts) {
  if (part_.empty()) {
    return;
  }
  const std::uint32_t* const end = HWY_DYNAMIC_DISPATCH(scan)(rows_, query, found_.data(), blocks_compared_);
  const auto before = static_cast<std::ptrdiff_t>(parts.size());
  for (const std::uint32_t* row = found_.data(); row != end; ++row) {
    if (overlaps(*table_, query, part_[*row])) {
      parts.push_back(part_[*row]);
    }
  }
  std::sort(parts.begin() + before, parts.end());
}

}  // namespace sightline::layers
#endif
