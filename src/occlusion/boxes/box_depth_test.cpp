#include "src/occlusion/boxes/box_depth_test.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

#include "src/occlusion/boxes/box_outline.h"
#include "src/occlusion/boxes/box_point.h"
#include "src/occlusion/eye_box.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/occlusion/boxes/box_depth_test.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::occlusion {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<float, kBlock>;

// The set bit of a number other than 0 that has as many of its bits before it as after it.
HWY_INLINE std::uint32_t middleBit(std::uint32_t bits) {
  for (int before = (std::popcount(bits) - 1) / 2; before > 0; --before) {
    bits &= bits - 1;
  }
  return static_cast<std::uint32_t>(std::countr_zero(bits));
}

// The first and last cells of a range of a level, at most eight along each axis.
struct CellRange {
  std::uint32_t x0, y0, x1, y1;
};

struct Cell {
  std::uint32_t level, x, y;
};

HWY_INLINE CellRange cellsOf(const PixelBox& image, std::uint32_t level) {
  const std::uint32_t shift = kBlockShift * level;
  const std::uint32_t x0 = image.x0, y0 = image.y0, x1 = image.x1, y1 = image.y1;
  return {x0 >> shift, y0 >> shift, x1 >> shift, y1 >> shift};
}

// Returns the cells within cell (x, y) of the level above that the image reaches.
HWY_INLINE CellRange cellsWithin(const PixelBox& image, std::uint32_t level, std::uint32_t x,
                                 std::uint32_t y) {
  const CellRange all = cellsOf(image, level);
  return {std::max(all.x0, x * kBlock), std::max(all.y0, y * kBlock),
          std::min(all.x1, x * kBlock + kBlock - 1), std::min(all.y1, y * kBlock + kBlock - 1)};
}

// Returns the first of eight cells that contain the range and all lie in the row.
HWY_INLINE std::uint32_t readFrom(const DepthLevel& level, const CellRange& range) {
  return std::min(range.x0, level.stride - kBlock);
}

// Calls use(lane, mask of the range's cells, their positions) for the groups of lanes of eight cells.
template <typename Use>
HWY_INLINE void forLanes(const CellRange& range, std::uint32_t from, Use&& use) {
  const Lanes d;
  const auto x0 = hn::Set(d, static_cast<float>(range.x0)), x1 = hn::Set(d, static_cast<float>(range.x1));
  for (std::size_t lane = 0; lane < kBlock; lane += hn::Lanes(d)) {
    const auto x = hn::Add(hn::Set(d, static_cast<float>(from + lane)), hn::Iota(d, 0.0f));
    use(lane, hn::And(hn::Ge(x, x0), hn::Le(x, x1)), x);
  }
}

HWY_INLINE std::uint32_t bitsOf(hn::Mask<Lanes> mask, std::size_t lane) {
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(Lanes(), mask, bits);
  return static_cast<std::uint32_t>(bits[0]) << lane;
}

// Returns a pixel with the least reciprocal depth of the cell.
BufferPixel farthestPixel(std::span<const DepthLevel> levels, Cell cell) {
  const Lanes d;
  while (cell.level > 0) {
    const float least = levels[cell.level].min[std::size_t{cell.y} * levels[cell.level].stride + cell.x];
    const DepthLevel& below = levels[--cell.level];
    const CellRange range{cell.x * kBlock, cell.y * kBlock,
                          std::min(cell.x * kBlock + kBlock, below.width) - 1,
                          std::min(cell.y * kBlock + kBlock, below.height) - 1};
    const std::uint32_t from = readFrom(below, range);
    std::uint32_t found = 0;
    for (cell.y = range.y0; found == 0 && cell.y <= range.y1; ++cell.y) {
      const float* row = below.min + std::size_t{cell.y} * below.stride + from;
      forLanes(range, from, [&](std::size_t lane, auto in_range, auto) HWY_ATTR {
        found |= bitsOf(hn::And(in_range, hn::Eq(hn::LoadU(d, row + lane), hn::Set(d, least))), lane);
      });
    }
    cell.y -= 1;
    cell.x = found != 0 ? from + middleBit(found) : range.x0;
  }
  return {static_cast<std::uint16_t>(cell.x), static_cast<std::uint16_t>(cell.y)};
}

// Whether the reciprocal depth of every cell is greater than `than`. Always reads eight rows, the last one
// several times: branches that depend on the box are mostly foreseen wrongly.
HWY_INLINE bool allNearer(const DepthLevel& level, const CellRange& range, float than) {
  const Lanes d;
  const std::uint32_t from = readFrom(level, range);
  bool all = true;
  forLanes(range, from, [&](std::size_t lane, auto in_range, auto) HWY_ATTR {
    const float* row = level.min + std::size_t{range.y0} * level.stride + from + lane;
    auto min = hn::LoadU(d, row);
    for (std::uint32_t i = 1; i < kBlock; ++i) {
      row += range.y0 + i <= range.y1 ? level.stride : 0;
      min = hn::Min(min, hn::LoadU(d, row));
    }
    all = all && hn::AllFalse(d, hn::And(in_range, hn::Not(hn::Gt(min, hn::Set(d, than)))));
  });
  return all;
}

// Whether the reciprocal depth of some pixel of the image's rectangle is greater than `than`.
bool anyNearer(std::span<const DepthLevel> levels, std::uint32_t level, const PixelBox& image,
               const CellRange& range, float than) {
  const Lanes d;
  const std::uint32_t from = readFrom(levels[level], range), shift = kBlockShift * level;
  for (std::uint32_t y = range.y0; y <= range.y1; ++y) {
    const float* row = levels[level].max + std::size_t{y} * levels[level].stride + from;
    std::uint32_t nearer = 0;
    forLanes(range, from, [&](std::size_t lane, auto in_range, auto) HWY_ATTR {
      nearer |= bitsOf(hn::And(in_range, hn::Gt(hn::LoadU(d, row + lane), hn::Set(d, than))), lane);
    });
    for (; nearer != 0; nearer &= nearer - 1) {
      const std::uint32_t x = from + static_cast<std::uint32_t>(std::countr_zero(nearer));
      const bool inside = x << shift >= image.x0 && y << shift >= image.y0 &&
                          ((x + 1) << shift) - 1 <= image.x1 && ((y + 1) << shift) - 1 <= image.y1;
      if (inside || anyNearer(levels, level - 1, image, cellsWithin(image, level - 1, x, y), than)) {
        return true;
      }
    }
  }
  return false;
}

// Compares one box with cells by its own outline and depth.
struct Refinement {
  std::span<const DepthLevel> levels;
  PixelBox image;             // the pixels that are compared, and the box's depths
  const BoxOutline& outline;  // its functions are of pixels from (x0, y0)
  float x0, y0;
  std::uint32_t rows_left = ~0u;  // of eight cells; then what is left counts as open
  // Set by anyOpen() where it finds one: a cell in whose farthest pixel the box is not surely hidden.
  std::optional<Cell> open;

  Refinement(std::span<const DepthLevel> l, const PixelBox& i, const BoxOutline& o)
      : levels(l), image(i), outline(o), x0(i.x0), y0(i.y0) {}

  // The result for the cells of a range, row by row; bit i is for the cell `from` + i.
  struct Cells {
    std::uint32_t from = 0;
    std::uint8_t open[kBlock] = {};    // cells where the box is not surely hidden
    std::uint8_t surely[kBlock] = {};  // among them: in some pixel of the cell the box is surely not hidden
  };

  HWY_INLINE Cells ask(std::uint32_t level, const CellRange& range) const {
    const Lanes d;
    const DepthLevel& cells = levels[level];
    const float size = static_cast<float>(1u << (kBlockShift * level));
    const auto x_origin = hn::Set(d, x0), nearest = hn::Set(d, image.nearest),
               farthest = hn::Set(d, image.farthest);
    float y_px[kBlock];
    for (std::uint32_t i = 0; i < kBlock; ++i) {
      y_px[i] = static_cast<float>(static_cast<std::int32_t>(range.y0 + i)) * size - y0;
    }
    const std::uint32_t rows = range.y1 - range.y0 + 1;
    Cells result;
    result.from = readFrom(cells, range);
    // The functions' values at the lower left corner of a cell, where those over the cell are greatest, and
    // how much less they may be elsewhere in it.
    float at_corner[BoxOutline::kSlots], across[BoxOutline::kSlots];
    for (std::uint32_t slot = 0; slot < BoxOutline::kSlots; ++slot) {
      const float x = outline.along_x[slot], y = outline.along_y[slot];
      at_corner[slot] = outline.at_origin[slot] + (std::max(x, 0.0f) + std::max(y, 0.0f)) * size;
      across[slot] = (std::abs(x) + std::abs(y)) * size;
    }
    float of_row[BoxOutline::kSlots][kBlock];
    for (std::uint32_t slot = 0; slot < BoxOutline::kSlots; ++slot) {
      for (std::uint32_t i = 0; i < kBlock; ++i) {
        of_row[slot][i] = outline.along_y[slot] * y_px[i] + at_corner[slot];
      }
    }
    forLanes(range, result.from, [&](std::size_t lane, auto in_range, auto x) HWY_ATTR {
      const auto x_px = hn::Sub(hn::Mul(x, hn::Set(d, size)), x_origin);
      hn::Vec<Lanes> of_column[BoxOutline::kSlots];
      for (std::uint32_t slot = 0; slot < BoxOutline::kSlots; ++slot) {
        of_column[slot] = hn::Mul(hn::Set(d, outline.along_x[slot]), x_px);
      }
      const auto at = [&](std::uint32_t slot, std::uint32_t row)
                          HWY_ATTR { return hn::Add(of_column[slot], hn::Set(d, of_row[slot][row])); };
      const float* from = cells.min + std::size_t{range.y0} * cells.stride + result.from + lane;
      for (std::uint32_t row = 0; row < rows; ++row, from += cells.stride) {
        const auto min = hn::LoadU(d, from);
        auto own = nearest;
        for (std::uint32_t i = 0; i < BoxOutline::kFaces; ++i) {
          own = hn::Min(own, at(BoxOutline::kFirstFace + i, row));
        }
        auto unhidden = hn::And(in_range, hn::Le(min, own));
        if (hn::AllFalse(d, unhidden)) {
          continue;
        }
        for (std::uint32_t i = 0; i < BoxOutline::kEdges; ++i) {
          unhidden = hn::And(unhidden, hn::Ge(at(i, row), hn::Zero(d)));
        }
        // A pixel of the cell is not before the box's farthest point.
        auto surely = hn::And(unhidden, hn::Le(min, farthest));
        if (!hn::AllFalse(d, surely)) {
          // All of the cell lies in the outline.
          for (std::uint32_t i = 0; i < BoxOutline::kEdges; ++i) {
            surely = hn::And(surely, hn::Ge(at(i, row), hn::Set(d, across[i])));
          }
        }
        result.open[row] |= static_cast<std::uint8_t>(bitsOf(unhidden, lane));
        result.surely[row] |= static_cast<std::uint8_t>(bitsOf(surely, lane));
      }
    });
    return result;
  }

  // Sets which pixels are compared from now on.
  void compare(const PixelRange& range) {
    image.x0 = range.x0;
    image.y0 = range.y0;
    image.x1 = range.x1;
    image.y1 = range.y1;
  }

  // Whether so many more rows of eight cells may be compared.
  bool mayCompare(std::uint32_t rows) {
    const bool may = rows <= rows_left;
    rows_left = may ? rows_left - rows : 0;
    return may;
  }

  // Sets `open` to a cell in the middle of those that are marked. False: none is.
  bool settle(std::uint32_t level, std::uint32_t first_row, std::uint32_t from,
              const std::uint8_t (&marks)[kBlock]) {
    std::uint32_t rows = 0;
    for (std::uint32_t i = 0; i < kBlock; ++i) {
      rows |= static_cast<std::uint32_t>(marks[i] != 0) << i;
    }
    if (rows == 0) {
      return false;
    }
    const std::uint32_t row = middleBit(rows);
    open = {level, from + middleBit(marks[row]), first_row + row};
    return true;
  }

  // Whether in some pixel of these cells the box is not surely hidden.
  bool anyOpen(std::uint32_t level, const CellRange& range) {
    if (!mayCompare(range.y1 - range.y0 + 1)) {
      return true;
    }
    const Cells cells = ask(level, range);
    if (settle(level, range.y0, cells.from, cells.surely) ||
        (level == 0 && settle(level, range.y0, cells.from, cells.open))) {
      return true;
    }
    for (std::uint32_t y = range.y0; y <= range.y1; ++y) {
      for (std::uint32_t bits = cells.open[y - range.y0]; bits != 0; bits &= bits - 1) {
        const std::uint32_t x = cells.from + static_cast<std::uint32_t>(std::countr_zero(bits));
        if (anyOpen(level - 1, cellsWithin(image, level - 1, x, y))) {
          return true;
        }
      }
    }
    return false;
  }

  // Appends the pixels in which the box is not surely hidden. Ends early, returning false, where `pixels`
  // would get more than `max`, or where it takes too many rows.
  bool findOpen(std::uint32_t level, const CellRange& range, std::size_t max,
                std::vector<BufferPixel>& pixels) {
    if (!mayCompare(range.y1 - range.y0 + 1)) {
      return false;
    }
    const Cells cells = ask(level, range);
    for (std::uint32_t y = range.y0; y <= range.y1; ++y) {
      for (std::uint32_t bits = cells.open[y - range.y0]; bits != 0; bits &= bits - 1) {
        const std::uint32_t x = cells.from + static_cast<std::uint32_t>(std::countr_zero(bits));
        if (level > 0) {
          if (!findOpen(level - 1, cellsWithin(image, level - 1, x, y), max, pixels)) {
            return false;
          }
        } else if (pixels.size() < max) {
          pixels.push_back({static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y)});
        } else {
          return false;
        }
      }
    }
    return true;
  }
};

// The cells of the finest level on which the image has at most eight cells along each side.
HWY_INLINE CellRange finestRange(const PixelBox& image, std::uint32_t& level) {
  const auto isTooFine = [&](std::uint32_t at) HWY_ATTR {
    const CellRange cells = cellsOf(image, at);
    return cells.x1 - cells.x0 >= kBlock || cells.y1 - cells.y0 >= kBlock ? 1u : 0u;
  };
  level = 0;
  for (std::uint32_t at = 0; at + 1 < DepthLevels::kMaxLevels; ++at) {
    level += isTooFine(at);
  }
  return cellsOf(image, level);
}

// How far from the image's first pixel its cells of a level reach, pixels: they may begin before it and end
// after it.
HWY_INLINE double reachOf(const PixelBox& image, std::uint32_t level) {
  const std::uint32_t size = 1u << (kBlockShift * level);
  return std::max(image.x1 - image.x0, image.y1 - image.y0) + 2.0 * size;
}

// Whether the buffer, in the pixel of the box's centre, is not before the box's farthest point. The outline
// surely intersects that pixel. This settles most boxes that can be seen.
HWY_INLINE bool seenAtCentre(const DepthLevel& buffer, const scene::PixelView& view, const Box& box,
                             const PixelBox& image) {
  const Vec3d centre = view.toCamera(center(box) - view.eye);
  const double inverse = view.inverseDepth(centre);
  const double x = view.pixelX(centre, inverse), y = view.pixelY(centre, inverse);
  if (!(x >= image.x0 && y >= image.y0 && x < image.x1 + 1.0 && y < image.y1 + 1.0)) {
    return false;
  }
  const std::size_t at = static_cast<std::size_t>(y) * buffer.stride + static_cast<std::size_t>(x);
  return !(buffer.min[at] > image.farthest);
}

float rounded(double value) {
  return static_cast<float>(std::min<double>(value, std::numeric_limits<float>::max()));
}

// Whether the outline and the faces of a box can be computed wherever it lies.
bool hasOutline(const OutlineView& view, const Box& box) {
  constexpr double kLargest = 0x1p60;  // metres; products stay finite
  return view.sane && box.wellFormed() && maxComponent(EyeBox::of(box, view.view.eye).reach()) < kLargest;
}

// Sets *seen_point, unless it is null, to a point of the box in the farthest pixel of the cell, if there is
// one.
void setPoint(std::span<const DepthLevel> levels, const scene::PixelView& view, const Box& box,
              const std::optional<Cell>& open, Vec3f* seen_point) {
  if (open && seen_point != nullptr) {
    *seen_point = pointInPixel(view, box, farthestPixel(levels, *open));
  }
}

// Whether the buffer hides all of a box that reaches the near plane. Such a box has no rectangle, but its
// outline and its faces hold for those points of it that are before the eye.
// Where the box is not hidden, *seen_point becomes a point of it that may be seen, as in setPoint().
bool hidesUnbounded(std::span<const DepthLevel> levels, const OutlineView& outline_view, const Box& box,
                    Vec3f* seen_point) {
  const scene::PixelView& view = outline_view.view;
  constexpr std::uint32_t kMaxRows = 1 << 13;  // of eight cells; a box that takes more of them is kept
  if (!hasOutline(outline_view, box)) {
    return false;
  }
  const DepthLevel &buffer = levels.front(), &top = levels.back();
  const auto level = static_cast<std::uint32_t>(levels.size() - 1);
  const CellRange all{0, 0, top.width - 1, top.height - 1};
  PixelBox image;
  image.x1 = static_cast<std::uint16_t>(buffer.width - 1);
  image.y1 = static_cast<std::uint16_t>(buffer.height - 1);
  image.nearest = rounded(view.reciprocalDepth(view.frustum_near));
  image.farthest = rounded(view.reciprocalDepth(dot(abs(view.forward), EyeBox::of(box, view.eye).reach())));
  // An empty buffer hides nothing, not even what lies beside the view.
  if (!anyNearer(levels, level, image, all, kUncovered)) {
    return false;
  }
  const double reach = std::max(buffer.width, buffer.height) + 2.0 * (1u << (kBlockShift * level));
  const BoxOutline outline = outlineOf(outline_view, box, 0, 0, reach);
  if (!outline.has_faces) {
    return false;  // the eye is in the box or on it, or nothing is known of its faces
  }
  Refinement refinement(levels, image, outline);
  refinement.rows_left = kMaxRows;
  const bool open = refinement.anyOpen(level, all);
  setPoint(levels, view, box, refinement.open, seen_point);
  return !open;
}

// What is known of a box before it is tested, and what is asked.
struct Question {
  bool plain = false;           // BoxHints::plain_from
  bool not_hidden = false;      // BoxHints::not_hidden
  Vec3f* seen_point = nullptr;  // BoxHints::seen_points
};

Visibility testOne(std::span<const DepthLevel> levels, const OutlineView& outline_view, const Box& box,
                   const PixelBox& image, const Question& question) {
  const scene::PixelView& view = outline_view.view;
  if (image.place == BoxPlace::kOutside) {
    return Visibility::kHidden;
  }
  if (levels.empty() || (question.plain && question.not_hidden)) {
    return Visibility::kPartial;
  }
  if (image.place == BoxPlace::kUnbounded) {
    return !question.not_hidden && hidesUnbounded(levels, outline_view, box, question.seen_point)
               ? Visibility::kHidden
               : Visibility::kPartial;
  }
  std::uint32_t level = 0;
  const CellRange range = finestRange(image, level);
  if (!question.not_hidden && allNearer(levels[level], range, image.nearest)) {
    return Visibility::kHidden;
  }
  if (!question.plain && !anyNearer(levels, level, image, range, image.farthest)) {
    return Visibility::kVisible;
  }
  // The centre is the first point that seesPoints() is asked about.
  if (question.not_hidden || (question.seen_point == nullptr && seenAtCentre(levels[0], view, box, image))) {
    return Visibility::kPartial;
  }
  const BoxOutline outline = outlineOf(outline_view, box, image.x0, image.y0, reachOf(image, level));
  Refinement refinement(levels, image, outline);
  if (refinement.anyOpen(level, range)) {
    setPoint(levels, view, box, refinement.open, question.seen_point);
    return Visibility::kPartial;
  }
  // A box of which the buffer hides nothing is kVisible, also for `plain`.
  return question.plain && !anyNearer(levels, level, image, range, image.farthest) ? Visibility::kVisible
                                                                                   : Visibility::kHidden;
}

void testAll(std::span<const DepthLevel> levels, const OutlineView& view, std::span<const Box> boxes,
             std::span<const PixelBox> images, std::span<BoxAnswer> answers, const BoxHints& hints) {
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const PixelBox& image = images[i];
    if (!hints.retest_delay.empty() && hints.retest_delay[i] != 0) {
      answers[i] =
          image.answer(image.place == BoxPlace::kOutside ? Visibility::kHidden : Visibility::kPartial);
      continue;
    }
    const Question question{.plain = i >= hints.plain_from,
                            .not_hidden = !hints.not_hidden.empty() && hints.not_hidden[i] != 0,
                            .seen_point = hints.seen_points.empty() ? nullptr : &hints.seen_points[i]};
    answers[i] = image.answer(testOne(levels, view, boxes[i], image, question));
  }
}

std::uint32_t openPixelsOf(std::span<const DepthLevel> levels, const OutlineView& outline_view,
                           const Box& box, const PixelBox& image, std::uint32_t max,
                           std::vector<BufferPixel>& pixels) {
  if (image.place == BoxPlace::kOutside) {
    return 0;
  }
  if (levels.empty() || image.place == BoxPlace::kUnbounded) {
    return kManyPixels;
  }
  constexpr std::uint32_t kMaxRows = 64;  // of eight cells; a box that takes more of them has many pixels
  std::uint32_t level = 0;
  const CellRange range = finestRange(image, level);
  if (allNearer(levels[level], range, image.nearest)) {
    return 0;
  }
  const BoxOutline outline = outlineOf(outline_view, box, image.x0, image.y0, reachOf(image, level));
  const std::size_t before = pixels.size();
  Refinement refinement(levels, image, outline);
  refinement.rows_left = kMaxRows;
  if (!refinement.findOpen(level, range, before + max, pixels)) {
    pixels.resize(before);
    return kManyPixels;
  }
  return static_cast<std::uint32_t>(pixels.size() - before);
}

void openPixels(std::span<const DepthLevel> levels, const OutlineView& view, std::span<const Box> boxes,
                std::span<const PixelBox> images, std::uint32_t max, std::span<std::uint32_t> counts,
                std::vector<BufferPixel>& pixels) {
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    counts[i] = openPixelsOf(levels, view, boxes[i], images[i], max, pixels);
  }
}

bool hidesWithin(std::span<const DepthLevel> levels, const OutlineView& outline_view, const Box& box,
                 std::span<const PixelRange> ranges) {
  if (levels.empty() || !hasOutline(outline_view, box)) {
    return false;
  }
  PixelBox image;                                     // the rectangle around the ranges
  image.nearest = std::numeric_limits<float>::max();  // its faces say more
  image.farthest = kUncovered;
  image.x0 = image.y0 = std::numeric_limits<std::uint16_t>::max();
  for (const PixelRange& range : ranges) {
    image.x0 = std::min(image.x0, range.x0);
    image.y0 = std::min(image.y0, range.y0);
    image.x1 = std::max(image.x1, range.x1);
    image.y1 = std::max(image.y1, range.y1);
  }
  std::uint32_t level = 0;
  finestRange(image, level);
  const BoxOutline outline = outlineOf(outline_view, box, image.x0, image.y0, reachOf(image, level));
  if (!outline.has_faces) {
    return false;
  }
  Refinement refinement(levels, image, outline);
  for (const PixelRange& range : ranges) {
    refinement.compare(range);
    const CellRange cells = finestRange(refinement.image, level);
    if (refinement.anyOpen(level, cells)) {
      return false;
    }
  }
  return true;
}

}  // namespace HWY_NAMESPACE
}  // namespace sightline::occlusion
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::occlusion {

HWY_EXPORT(testAll);
HWY_EXPORT(openPixels);
HWY_EXPORT(hidesWithin);

void findOpenPixels(std::span<const DepthLevel> levels, const OutlineView& view, std::span<const Box> boxes,
                    std::span<const PixelBox> images, std::uint32_t max, std::span<std::uint32_t> counts,
                    std::vector<BufferPixel>& pixels) {
  HWY_DYNAMIC_DISPATCH(openPixels)(levels, view, boxes, images, max, counts, pixels);
}

bool hidesBoxWithin(std::span<const DepthLevel> levels, const OutlineView& view, const Box& box,
                    std::span<const PixelRange> ranges) {
  return HWY_DYNAMIC_DISPATCH(hidesWithin)(levels, view, box, ranges);
}

void testBoxes(std::span<const DepthLevel> levels, const OutlineView& view, std::span<const Box> boxes,
               std::span<const PixelBox> images, std::span<BoxAnswer> answers, const BoxHints& hints) {
  HWY_DYNAMIC_DISPATCH(testAll)(levels, view, boxes, images, answers, hints);
}

}  // namespace sightline::occlusion
#endif
