#include "layers/extent_scan.h"

#include <algorithm>
#include <bit>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "layers/extent_scan.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::layers {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Lanes = hn::CappedTag<float, ExtentTable::kPadding>;
using Mask = hn::Mask<Lanes>;

// An axis, and what its intervals are compared with: the query, and the query a turn on and back where one of
// them can overlap anything.
struct Column {
  const float* lows;
  const float* highs;
  std::uint32_t shifts = 1;
  float low[3], high[3];
};

Column columnOf(const ExtentTable& table, std::size_t axis, const Interval& query, const Interval& all) {
  Column column;
  column.lows = table.lows[axis].data();
  column.highs = table.highs[axis].data();
  column.low[0] = query.low;
  column.high[0] = query.high;
  if (table.angular(axis)) {
    for (const float turn : {4.0f, -4.0f}) {
      const Interval shifted{query.low + turn, query.high + turn};
      if (overlapsSpatial(shifted, all)) {
        column.low[column.shifts] = shifted.low;
        column.high[column.shifts++] = shifted.high;
      }
    }
  }
  return column;
}

HWY_INLINE Mask overlap(const Column& column, std::size_t first) {
  const Lanes d;
  const auto lows = hn::LoadU(d, column.lows + first), highs = hn::LoadU(d, column.highs + first);
  Mask any = hn::And(hn::Ge(highs, hn::Set(d, column.low[0])), hn::Le(lows, hn::Set(d, column.high[0])));
  for (std::uint32_t i = 1; i < column.shifts; ++i) {
    any = hn::Or(any,
                 hn::And(hn::Ge(highs, hn::Set(d, column.low[i])), hn::Le(lows, hn::Set(d, column.high[i]))));
  }
  return any;
}

HWY_INLINE std::uint32_t bitsOf(Mask mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(Lanes(), mask, bytes);
  return bytes[0] | static_cast<std::uint32_t>(bytes[1]) << 8;
}

// Rows [first, first + lanes) that overlap along all axes.
HWY_INLINE std::uint64_t overlapBits(const Column* columns, std::size_t axes, std::size_t first) {
  Mask mask = overlap(columns[0], first);
  for (std::size_t axis = 1; axis < axes; ++axis) {
    if (hn::AllFalse(Lanes(), mask)) {
      return 0;
    }
    mask = hn::And(mask, overlap(columns[axis], first));
  }
  return bitsOf(mask);
}

void appendRows(std::uint64_t bits, std::size_t first, std::vector<std::uint32_t>& rows) {
  for (; bits != 0; bits &= bits - 1) {
    rows.push_back(static_cast<std::uint32_t>(first) + static_cast<std::uint32_t>(std::countr_zero(bits)));
  }
}

// active: a word a block. Appends rows.
void scan(const ScanTables& tables, const Extent& query, const std::uint64_t* active,
          std::vector<std::uint32_t>& rows) {
  const std::size_t lanes = hn::Lanes(Lanes()), axes = tables.rows.axes();
  const std::uint64_t lane_bits = (std::uint64_t{1} << lanes) - 1;
  Column row_columns[kMostExtentAxes], block_columns[kMostExtentAxes];
  for (std::size_t axis = 0; axis < axes; ++axis) {
    row_columns[axis] = block_columns[axis] = columnOf(tables.rows, axis, query[axis], tables.all[axis]);
    block_columns[axis].lows = tables.blocks.lows[axis].data();
    block_columns[axis].highs = tables.blocks.highs[axis].data();
  }
  for (std::size_t first = 0; first < tables.blocks.parts; first += lanes) {
    std::uint64_t blocks = axes == 0 ? lane_bits : overlapBits(block_columns, axes, first);
    for (; blocks != 0; blocks &= blocks - 1) {
      const std::size_t block = first + static_cast<std::size_t>(std::countr_zero(blocks));
      const std::uint64_t word = block < tables.blocks.parts ? active[block] : 0;
      for (std::size_t i = 0; i < 64 && (word >> i) != 0; i += lanes) {
        const std::uint64_t bits = (word >> i) & lane_bits;
        if (bits != 0) {
          appendRows(axes == 0 ? bits : bits & overlapBits(row_columns, axes, 64 * block + i), 64 * block + i,
                     rows);
        }
      }
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sightline::layers
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::layers {

HWY_EXPORT(scan);

namespace {

constexpr Interval kNothing{std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()};

// Room for so many rows, and padding that overlaps nothing.
void padColumn(std::size_t rows, std::vector<float>& column) {
  column.resize((rows + ExtentTable::kPadding - 1) / ExtentTable::kPadding * ExtentTable::kPadding);
  std::fill(column.begin() + static_cast<std::ptrdiff_t>(rows), column.end(),
            std::numeric_limits<float>::quiet_NaN());
}

// Some rows of a table, in their order.
void copyRows(const ExtentTable& from, std::span<const std::uint32_t> rows, ExtentTable& to) {
  to.kinds = from.kinds;
  to.parts = rows.size();
  const auto copyColumn = [&](const std::vector<float>& source, std::vector<float>& target) {
    padColumn(rows.size(), target);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      target[i] = source[rows[i]];
    }
  };
  to.lows.resize(from.axes());
  to.highs.resize(from.axes());
  for (std::size_t axis = 0; axis < from.axes(); ++axis) {
    copyColumn(from.lows[axis], to.lows[axis]);
    copyColumn(from.highs[axis], to.highs[axis]);
  }
}

}  // namespace

void ExtentScan::begin(const ExtentTable& table, std::span<const std::uint32_t> order) {
  part_.assign(order.begin(), order.end());
  place_.assign(table.parts, kNowhere);
  for (std::uint32_t place = 0; place < part_.size(); ++place) {
    place_[part_[place]] = place;
  }
  copyRows(table, part_, tables_.rows);
  uniteBlocks();
  active_.assign((part_.size() + 63) / 64, ~std::uint64_t{0});
  if (part_.size() % 64 != 0) {
    active_.back() = (std::uint64_t{1} << (part_.size() % 64)) - 1;
  }
}

// Of angles as numbers on a line: whatever overlaps a member a turn on or back overlaps the union there, too.
void ExtentScan::uniteBlocks() {
  const ExtentTable& rows = tables_.rows;
  ExtentTable& blocks = tables_.blocks;
  blocks.kinds = rows.kinds;
  blocks.parts = (rows.parts + 63) / 64;
  blocks.lows.resize(rows.axes());
  blocks.highs.resize(rows.axes());
  for (std::size_t axis = 0; axis < rows.axes(); ++axis) {
    padColumn(blocks.parts, blocks.lows[axis]);
    padColumn(blocks.parts, blocks.highs[axis]);
    tables_.all[axis] = kNothing;
    for (std::size_t block = 0; block < blocks.parts; ++block) {
      Interval united = kNothing;
      for (std::size_t row = 64 * block; row < std::min(64 * block + 64, rows.parts); ++row) {
        united = unite(united, rows.at(axis, static_cast<std::uint32_t>(row)));
      }
      blocks.lows[axis][block] = united.low;
      blocks.highs[axis][block] = united.high;
      tables_.all[axis] = unite(tables_.all[axis], united);
    }
  }
}

void ExtentScan::setActive(std::uint32_t part, bool active) {
  const std::uint32_t place = place_[part];
  if (place == kNowhere) {
    return;
  }
  const std::uint64_t bit = std::uint64_t{1} << (place % 64);
  active_[place / 64] = active ? active_[place / 64] | bit : active_[place / 64] & ~bit;
}

void ExtentScan::query(const Extent& query, std::vector<std::uint32_t>& parts) {
  const auto before = static_cast<std::ptrdiff_t>(parts.size());
  HWY_DYNAMIC_DISPATCH(scan)(tables_, query, active_.data(), parts);
  const auto found = parts.begin() + before;
  std::transform(found, parts.end(), found, [&](std::uint32_t place) { return part_[place]; });
  std::sort(found, parts.end());
}

}  // namespace sightline::layers
#endif
