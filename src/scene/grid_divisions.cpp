#include "src/scene/grid_divisions.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/scene/grid_divisions.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::scene {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Masks = hn::CappedTag<std::uint32_t, 16>;
using MasksV = hn::Vec<Masks>;
inline constexpr Masks kMasks;
using Sets = hn::CappedTag<std::uint32_t, 4>;
inline constexpr Sets kSets;

constexpr float kFar = std::numeric_limits<float>::infinity();
// By which each box counts as thicker, along all axes: a share of the longest side of the whole box.
constexpr float kThickness = 1.0f / 16.0f;
// A share of the box's volume, by which planes near its ends rank behind those in the middle. All planes
// across a door frame save the same, and thin slices of its ends would use up the divisions. The slices of a
// hollow shell's ends save a little, which hides that its quarters would save much: so a larger share is
// tried where all divisions save less than kLittle of the whole box.
constexpr float kOffCentre = 1e-3f, kFarOffCentre = 1e-1f, kLittle = 0.1f;

// Slabs along one axis, of which the first and the last one are not empty.
struct Reach {
  std::uint32_t first = 0, last = 0;
  // Where that begins and ends which is in them: at a plane that divides it from the rest, or in the middle
  // of a slab, as more is not known.
  float low = 0.0f, high = 0.0f;
};

struct Block {
  std::array<Reach, 3> along{};  // by axis
  float volume = 0.0f;
  bool done = false;             // it is divided or cannot be
  std::uint32_t most_boxes = 1;  // the greatest number that its divisions give, at most max_boxes_
};

// By slab along one axis: what there is along the two axes that follow it.
struct Filled {
  SlabMasks next{}, after{};

  bool empty(std::uint32_t slab) const { return next[slab] == 0; }
};

// What there is in some slabs along one axis: slabs along the two axes that follow it.
struct Contents {
  std::uint32_t next = 0, after = 0;

  HWY_INLINE void add(const Filled& filled, std::uint32_t slab) {
    next |= filled.next[slab];
    after |= filled.after[slab];
  }
};

struct Division {
  float rank = kFar;  // the less, the better
  int axis = 0;
  std::uint32_t plane = 0;  // it is below this slab, which is not empty
  std::uint32_t lower = 0;  // the last slab below it that is not empty
  Contents below, above;
};

HWY_INLINE std::uint32_t firstOf(std::uint32_t bits) {
  return static_cast<std::uint32_t>(std::countr_zero(bits));
}
HWY_INLINE std::uint32_t lastOf(std::uint32_t bits) {
  return static_cast<std::uint32_t>(std::bit_width(bits)) - 1;
}

// So many rows are transposed where there are so many slabs.
HWY_INLINE std::uint32_t rowsOf(std::uint32_t slabs) {
  return slabs > 16 ? 32 : 16;
}

// Rows become columns, of four sets of masks at once: bit i of the mask j is what bit j of the mask i was.
// Exchanges ever smaller blocks of bits (H. S. Warren, Hacker's Delight, 2002, section 7-3). slabs: beyond so
// many masks and bits all are 0. All of the blocks are exchanged, since on their way bits pass through masks
// beyond.
HWY_INLINE void transpose(std::uint32_t (&sets)[kMaxSlabs][4], std::uint32_t slabs) {
  static_assert(kMaxSlabs == 32);
  const std::uint32_t rows = rowsOf(slabs);
  std::uint32_t mask = slabs > 16 ? 0x0000ffffu : 0x00ff00ffu;
  for (std::uint32_t size = rows / 2; size != 0; size /= 2, mask ^= mask << size) {
    for (std::uint32_t row = 0; row < rows; row = (row + size + 1) & ~size) {
      for (std::size_t set = 0; set < 4; set += hn::Lanes(kSets)) {
        const auto a = hn::Load(kSets, &sets[row][set]), b = hn::Load(kSets, &sets[row + size][set]);
        const auto change =
            hn::And(hn::Xor(hn::ShiftRightSame(a, static_cast<int>(size)), b), hn::Set(kSets, mask));
        hn::Store(hn::Xor(b, change), kSets, &sets[row + size][set]);
        hn::Store(hn::Xor(a, hn::ShiftLeftSame(change, static_cast<int>(size))), kSets, &sets[row][set]);
      }
    }
  }
}

class Divider {
 public:
  Divider(const CellGrid& grid, const DivisionSettings& settings, DivisionTree& tree)
      : grid_(grid), max_boxes_(settings.max_boxes), tree_(tree) {
    for (int axis = 0; axis < 3; ++axis) {
      const Slabs& slabs = grid_.slabs(axis);
      for (std::uint32_t slab = 0; slab < kMaxSlabs; ++slab) {
        middles_[axis][slab] = 0.5f * (slabs.low[slab] + slabs.high[slab]);
      }
    }
  }

  HWY_NOINLINE void findTree(float off_centre, std::uint32_t max_divided, double min_saving) {
    off_centre_ = off_centre;
    Block whole;
    for (int axis = 0; axis < 3; ++axis) {
      const Slabs& slabs = grid_.slabs(axis);
      whole.along[axis] = {0, slabs.count - 1, 0.0f, slabs.high[slabs.count - 1]};
    }
    tree_.nodes[0] = {};
    tree_.node_count = 1;
    tree_.boxes = 1;
    tree_.cost = 0.0f;
    project(whole);
    Contents all;
    std::uint32_t own = 0;  // slabs along x that are not empty
    for (std::uint32_t slab = 0; slab <= whole.along[0].last; ++slab) {
      all.add(filled_[0], slab);
      own |= filled_[0].empty(slab) ? 0 : 1u << slab;
    }
    if (own == 0) {
      return;
    }
    blocks_[0] = partOf(whole, 0, firstOf(own), lastOf(own), all);
    const auto price = static_cast<float>(min_saving * blocks_[0].volume);
    // The largest one first, unless it cannot save as much as a box costs.
    for (std::uint32_t divided = 0; divided < max_divided; ++divided) {
      Block* largest = nullptr;
      for (std::uint32_t n = 0; n < tree_.node_count; ++n) {
        Block& block = blocks_[n];
        if (!block.done && block.volume > price && (!largest || block.volume > largest->volume)) {
          largest = &block;
        }
      }
      if (largest == nullptr) {
        break;
      }
      largest->done = true;
      divide(static_cast<std::uint32_t>(largest - blocks_.data()));
    }
    for (std::uint32_t n = tree_.node_count; n-- > 0;) {
      findMinVolumes(n);
    }
    tree_.cost = tree_.nodes[0].min_volume[1];
    for (std::uint32_t count = 2; count <= max_boxes_; ++count) {
      const float cost = tree_.nodes[0].min_volume[count] + price * static_cast<float>(count - 1);
      if (cost < tree_.cost) {
        tree_.boxes = count;
        tree_.cost = cost;
      }
    }
  }

 private:
  // Finds what fills the block's slabs.
  HWY_INLINE void project(const Block& block) {
    const auto& [along_x, along_y, along_z] = block.along;
    std::uint32_t slabs = 0;
    for (int axis = 0; axis < 3; ++axis) {
      slabs = std::max(slabs, grid_.slabs(axis).count);
    }
    alignas(64) SlabMasks within;  // by slab along y
    alignas(64) SlabMasks z_of_y;
    // By slab: along y of x, along z of x, along z of y.
    alignas(64) std::uint32_t sets[kMaxSlabs][4];
    for (std::size_t i = 0; i < slabs; i += hn::Lanes(kMasks)) {
      hn::Store(hn::Zero(kMasks), kMasks, &within[i]);
      hn::Store(hn::Zero(kMasks), kMasks, &z_of_y[i]);
    }
    for (std::size_t i = 0; i < 4 * rowsOf(slabs); i += hn::Lanes(kMasks)) {
      hn::Store(hn::Zero(kMasks), kMasks, &sets[0][0] + i);
    }
    std::fill(within.begin() + along_y.first, within.begin() + along_y.last + 1,
              (2u << along_z.last) - (1u << along_z.first));
    for (std::uint32_t x = along_x.first; x <= along_x.last; ++x) {
      const SlabMasks& marked = grid_.marked(x);
      MasksV all = hn::Zero(kMasks);
      for (std::size_t y = 0; y <= along_y.last; y += hn::Lanes(kMasks)) {
        const MasksV z = hn::And(hn::LoadU(kMasks, &marked[y]), hn::Load(kMasks, &within[y]));
        hn::Store(hn::Or(hn::Load(kMasks, &z_of_y[y]), z), kMasks, &z_of_y[y]);
        all = hn::Or(all, z);
        std::uint8_t bytes[8] = {};
        hn::StoreMaskBits(kMasks, hn::Ne(z, hn::Zero(kMasks)), bytes);
        sets[x][0] |= (bytes[0] | std::uint32_t{bytes[1]} << 8) << y;
      }
      alignas(64) std::uint32_t lanes[hn::MaxLanes(kMasks)];
      hn::Store(all, kMasks, lanes);
      for (std::size_t size = hn::Lanes(kMasks); size > 1; size /= 2) {
        for (std::size_t i = 0; i < size / 2; ++i) {
          lanes[i] |= lanes[i + size / 2];
        }
      }
      sets[x][1] = lanes[0];
    }
    for (std::uint32_t i = 0; i < slabs; ++i) {
      sets[i][2] = z_of_y[i];
      filled_[0].next[i] = sets[i][0];
      filled_[0].after[i] = sets[i][1];
      filled_[1].next[i] = z_of_y[i];
    }
    transpose(sets, slabs);
    for (std::uint32_t i = 0; i < slabs; ++i) {
      filled_[1].after[i] = sets[i][0];
      filled_[2].next[i] = sets[i][1];
      filled_[2].after[i] = sets[i][2];
    }
  }

  // Ranks the planes across an axis.
  HWY_INLINE void tryPlanes(const Block& block, int axis, Division& best) const {
    const Reach& whole = block.along[axis];
    const Filled& filled = filled_[axis];
    const Ends& next = ends_[axis < 2 ? axis + 1 : 0];
    const Ends& after = ends_[axis > 0 ? axis - 1 : 2];
    const auto areaOf = [&](const Contents& in) HWY_ATTR {
      return (kThickness + next.high[lastOf(in.next)] - next.low[firstOf(in.next)]) *
             (kThickness + after.high[lastOf(in.after)] - after.low[firstOf(in.after)]);
    };
    std::array<Contents, kMaxSlabs> from;  // by slab: what is in it and in all above it
    Contents above, below;
    for (std::uint32_t slab = whole.last + 1; slab-- > whole.first;) {
      above.add(filled, slab);
      from[slab] = above;
    }
    const std::array<float, kMaxSlabs>& planes = grid_.slabs(axis).low;
    const float centre = 0.5f * (whole.low + whole.high);
    const float off_centre = 2.0f * off_centre_ * block.volume / (whole.high - whole.low);
    std::uint32_t lower = whole.first;  // the last slab below the plane that is not empty
    below.add(filled, lower);
    for (std::uint32_t plane = whole.first + 1; plane <= whole.last; ++plane) {
      if (filled.empty(plane)) {
        continue;
      }
      const bool gap = lower + 1 != plane;
      const float end = gap ? middles_[axis][lower] : planes[plane];
      const float begin = gap ? middles_[axis][plane] : planes[plane];
      const float rank = areaOf(below) * (end - whole.low + kThickness) +
                         areaOf(from[plane]) * (whole.high - begin + kThickness) +
                         off_centre * std::abs(planes[plane] - centre);
      if (rank < best.rank) {
        best = {rank, axis, plane, lower, below, from[plane]};
      }
      below.add(filled, plane);
      lower = plane;
    }
  }

  // The block as far as it is not empty: from one slab along an axis to another one, and along the other axes
  // as far as there are contents.
  HWY_INLINE Block partOf(const Block& block, int axis, std::uint32_t first, std::uint32_t last,
                          const Contents& in) const {
    const int next = axis < 2 ? axis + 1 : 0, after = 3 - axis - next;
    Block part;
    part.volume = 1.0f;
    for (const auto& [along, low, high] : {std::tuple(axis, first, last),
                                           {next, firstOf(in.next), lastOf(in.next)},
                                           {after, firstOf(in.after), lastOf(in.after)}}) {
      Reach reach = block.along[along];
      if (low > reach.first) {
        reach.first = low;
        reach.low = middles_[along][low];
      }
      if (high < reach.last) {
        reach.last = high;
        reach.high = middles_[along][high];
      }
      part.along[along] = reach;
      part.volume *= reach.high - reach.low + kThickness;
    }
    return part;
  }

  HWY_INLINE void divide(std::uint32_t n) {
    const Block& block = blocks_[n];
    project(block);
    for (int axis = 0; axis < 3; ++axis) {
      const Reach& reach = block.along[axis];
      ends_[axis] = {middles_[axis], middles_[axis]};
      ends_[axis].low[reach.first] = reach.low;
      ends_[axis].high[reach.last] = reach.high;
    }
    Division best;
    for (int axis = 0; axis < 3; ++axis) {
      tryPlanes(block, axis, best);
    }
    if (best.rank == kFar) {
      return;  // it is a single cell
    }
    const Slabs& slabs = grid_.slabs(best.axis);
    DivisionTree::Node& node = tree_.nodes[n];
    node.first_half = tree_.node_count;
    node.axis = best.axis;
    node.plane = slabs.plane[best.plane];
    Block lower = block, upper = block;
    std::tie(lower.along[best.axis].last, lower.along[best.axis].high) =
        std::pair(best.plane - 1, slabs.low[best.plane]);
    std::tie(upper.along[best.axis].first, upper.along[best.axis].low) =
        std::pair(best.plane, slabs.low[best.plane]);
    const Reach& whole = block.along[best.axis];
    addHalf(partOf(lower, best.axis, whole.first, best.lower, best.below));
    addHalf(partOf(upper, best.axis, best.plane, whole.last, best.above));
  }

  HWY_INLINE void addHalf(const Block& half) {
    tree_.nodes[tree_.node_count].first_half = 0;
    blocks_[tree_.node_count++] = half;
  }

  // Precondition: that of the halves has been found.
  HWY_INLINE void findMinVolumes(std::uint32_t n) {
    DivisionTree::Node& node = tree_.nodes[n];
    node.min_volume.fill(blocks_[n].volume);
    node.in_first.fill(0);
    blocks_[n].most_boxes = 1;
    if (node.first_half == 0) {
      return;
    }
    const auto& first_half = tree_.nodes[node.first_half];
    const auto& second_half = tree_.nodes[node.first_half + 1];
    const std::uint32_t most_in_first = blocks_[node.first_half].most_boxes;
    const std::uint32_t most_in_second = blocks_[node.first_half + 1].most_boxes;
    blocks_[n].most_boxes = std::min(most_in_first + most_in_second, max_boxes_);
    for (std::uint32_t count = 2; count <= max_boxes_; ++count) {
      node.min_volume[count] = node.min_volume[count - 1];
      node.in_first[count] = node.in_first[count - 1];
      // More boxes than a half can have would save nothing in it.
      const std::uint32_t least = count > most_in_second ? count - most_in_second : 1;
      for (std::uint32_t first = least; first <= std::min(most_in_first, count - 1); ++first) {
        const float sum = first_half.min_volume[first] + second_half.min_volume[count - first];
        if (sum < node.min_volume[count]) {
          node.min_volume[count] = sum;
          node.in_first[count] = static_cast<std::uint8_t>(first);
        }
      }
    }
  }

  // By slab along an axis: where that begins and ends whose first or last slab it is.
  struct Ends {
    std::array<float, kMaxSlabs> low, high;
  };

  const CellGrid& grid_;
  std::uint32_t max_boxes_;
  DivisionTree& tree_;
  float off_centre_ = 0.0f;
  std::array<std::array<float, kMaxSlabs>, 3> middles_{};        // of slabs, by axis
  std::array<Block, 2 * DivisionTree::kMaxDivided + 1> blocks_;  // by node
  // These describe the block that is being divided, by axis.
  std::array<Filled, 3> filled_;
  std::array<Ends, 3> ends_;
};

void findTree(const CellGrid& grid, const DivisionSettings& settings, DivisionTree& tree) {
  Divider(grid, settings, tree).findTree(kOffCentre, settings.max_divided, settings.min_saving);
  if (tree.cost <= (1.0f - kLittle) * tree.nodes[0].min_volume[1]) {
    return;
  }
  DivisionTree other;
  Divider(grid, settings, other).findTree(kFarOffCentre, settings.max_divided, settings.min_saving);
  if (other.cost < tree.cost) {
    tree = other;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sightline::scene
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::scene {

HWY_EXPORT(findTree);

void findDivisions(const CellGrid& grid, const DivisionSettings& settings, DivisionTree& tree) {
  HWY_DYNAMIC_DISPATCH(findTree)(grid, settings, tree);
}

}  // namespace sightline::scene
#endif
