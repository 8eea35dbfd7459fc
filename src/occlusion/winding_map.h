#pragma once

// How often the boundary of a surface winds around each pixel of a depth buffer. See docs/conservative.md,
// "Surfaces".

#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace sightline::occlusion {

// What is drawn into; greater values are nearer.
struct DepthTarget {
  float* reciprocal_depth = nullptr;
  std::uint32_t width = 0, height = 0, stride = 0;  // stride: a multiple of 8, 8 or more above the width
};

// A point of the buffer in 256ths of a pixel, x to the right, y upwards.
struct GridPoint {
  double x = 0.0, y = 0.0;  // whole numbers
};
inline constexpr std::int32_t kGridShift = 8, kGridStep = 1 << kGridShift;
inline constexpr double kLargestGrid = 0x1p36;  // coordinates beyond it must not be used

struct PixelRectangle {
  std::int32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // first pixel, and the one after the last
  bool empty() const { return x0 >= x1 || y0 >= y1; }
  std::int32_t area() const { return (x1 - x0) * (y1 - y0); }
};

// A lower bound of the reciprocal depth over pixel (x, y): max(along_x x + along_y y + at_origin, floor).
struct DepthBound {
  float along_x = 0.0f, along_y = 0.0f, at_origin = 0.0f;
  float floor = 0.0f;
};

// A tile of a WindingMap. In each row there is a bit for each pixel, the leftmost one in the lowest bit.
struct alignas(64) WindingTile {
  static constexpr std::int32_t kWidth = 32, kHeight = 8;  // pixels
  static constexpr std::int32_t kPlanes = 4;               // bits of a winding
  // Lower bounds of windings in two's complement, one bit of them after the other, the lowest one first.
  std::uint32_t planes[kPlanes][kHeight];
  std::uint32_t unknown[kHeight];  // a winding here went beyond what its bits can hold
  std::int16_t carry[kHeight];     // what edges to the left of the tile add to all of a row
  float least;                     // of the target's values, or less
  bool stale;                      // it may be less

  void clear() {
    std::memset(planes, 0, sizeof(planes));
    std::memset(unknown, 0, sizeof(unknown));
    std::memset(carry, 0, sizeof(carry));
  }
};

// The depth of a group is kept for blocks of so many pixels; a tile has whole ones.
inline constexpr std::int32_t kFarWidth = 8, kFarHeight = 4;

// Which tiles of a row of them edges have changed; last < first: none.
struct WindingExtent {
  std::int32_t first = 0, last = -1;
};

// What edges are drawn into, in tiles.
struct WindingEdges {
  WindingTile* tiles;
  WindingExtent* extents;  // by row of tiles
  std::int32_t stride;
  PixelRectangle rectangle;  // pixels, whole tiles
};

// A row of tiles, and the pixels of the target to which it belongs.
struct WindingRow {
  WindingTile* tiles;
  std::int32_t first, last, end;  // the tiles that edges have changed, and the end of the group's rectangle
  float* reciprocal_depth;        // of the first pixel of the lowest row
  std::uint32_t stride;
  std::int32_t width, rows;  // pixels that there are
};

// Draws one group of surfaces after the other: begin(), all of its boundary with addEdges(), how far away it
// is with addDepth(), then resolve().
class WindingMap {
 public:
  // A pixel is surely covered only where corners are off by less than this, in 256ths of a pixel.
  static constexpr double kMargin = 1.0;

  void resize(const DepthTarget& target);

  // Whether all of a rectangle of the target is nearer than this reciprocal depth.
  bool hides(const PixelRectangle& rectangle, float nearest);

  void begin(const PixelRectangle& rectangle);
  // Adds the edges from each point to the next one, or only every second of them (step 2). The surface lies
  // to their left, `value` times.
  void addEdges(std::span<const GridPoint> points, std::uint32_t step, std::int32_t value);
  // Some of the group, no farther away than `depth`, may appear in these pixels.
  void addDepth(const PixelRectangle& rectangle, const DepthBound& depth);
  // Sets covered pixels of the target to the group's depth where that is nearer, and returns how many of them
  // become nearer by an eighth or more.
  std::uint32_t resolve();
  // The same for a group that is nowhere farther away than `depth`.
  std::uint32_t resolve(const DepthBound& depth);

  // Since resize(): edges drawn, and pixels of the tiles that were resolved.
  std::uint64_t edges() const { return edges_; }
  std::uint64_t pixels() const { return pixels_; }

 private:
  template <typename ResolveRow>
  std::uint32_t resolveRows(ResolveRow&& resolve_row);

  DepthTarget target_;
  PixelRectangle rectangle_;            // whole tiles
  std::int32_t columns_ = 0;            // of tiles
  std::vector<WindingTile> tiles_;      // all zero between groups
  std::vector<WindingExtent> extents_;  // by row of tiles
  std::uint32_t far_stride_ = 0;
  std::vector<float> far_;  // by block: the least reciprocal depth of the group
  std::uint64_t edges_ = 0, pixels_ = 0;
  std::uint64_t sum_ = 0;  // of the values of the group's edges
};

}  // namespace sightline::occlusion
