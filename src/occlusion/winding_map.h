#pragma once

// How often the boundary of a surface winds around each pixel of a depth buffer. See docs/conservative.md,
// "Surfaces".

#include <cstdint>
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

// A row of a WindingMap, and which pixels of it are to be covered.
struct WindingRow {
  std::int16_t* steps;
  std::int16_t* doubts;
  float* reciprocal_depth;
  std::int32_t first, last;  // pixels that edges have changed
  std::int32_t end;
};

// The first and last pixels of a row that edges have changed; last < first: none.
struct WindingExtent {
  std::int32_t first = 0, last = -1;
};

// What edges are drawn into.
struct WindingEdges {
  std::int16_t* steps;
  std::int16_t* doubts;
  WindingExtent* rows;
  std::uint32_t stride;
  PixelRectangle rectangle;
};

// Draws one group of surfaces after the other: begin(), all of its boundary with addEdges(), how far away it
// is with addDepth(), then resolve().
class WindingMap {
 public:
  // A pixel is surely covered only where corners are off by less than this, in 256ths of a pixel.
  static constexpr double kMargin = 1.0;

  void resize(const DepthTarget& target);

  // Whether all of a rectangle of the target is nearer than this reciprocal depth.
  bool hides(const PixelRectangle& rectangle, float nearest) const;

  void begin(const PixelRectangle& rectangle);
  // Adds the edges from each point to the next one, or only every second of them (step 2). The surface lies
  // to their left, `value` times.
  void addEdges(std::span<const GridPoint> points, std::uint32_t step, std::int32_t value);
  // Some of the group, no farther away than `depth`, may appear in these pixels.
  void addDepth(const PixelRectangle& rectangle, const DepthBound& depth);
  // Sets covered pixels of the target to the group's depth where that is nearer, and returns how many they
  // are.
  std::uint32_t resolve();
  // The same for a group that is nowhere farther away than `depth`.
  std::uint32_t resolve(const DepthBound& depth);

  // Since resize(): edges drawn, and pixels between the first and the last ones of their rows.
  std::uint64_t edges() const { return edges_; }
  std::uint64_t pixels() const { return pixels_; }

 private:
  template <typename ResolveRow>
  std::uint32_t resolveRows(ResolveRow&& resolve_row);

  DepthTarget target_;
  PixelRectangle rectangle_;
  std::vector<std::int16_t> steps_;   // by pixel: change of the winding from the pixel to its left
  std::vector<std::int16_t> doubts_;  // by pixel: how much lower the winding may be in a part of it
  std::vector<WindingExtent> rows_;
  std::uint32_t tile_stride_ = 0;
  std::vector<float> far_;  // by tile: the least reciprocal depth of the group
  std::uint64_t edges_ = 0, pixels_ = 0;
  std::uint64_t sum_ = 0;  // of the values of the group's edges
};

}  // namespace sightline::occlusion
