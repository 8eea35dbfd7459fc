#pragma once

// Edges of the boundary of a surface in a depth buffer, prepared for being drawn tile by tile.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <vector>

namespace sightline::occlusion {

// A point of the buffer in 256ths of a pixel, x to the right, y upwards.
struct GridPoint {
  double x = 0.0, y = 0.0;  // whole numbers
};
inline constexpr std::int32_t kGridShift = 8, kGridStep = 1 << kGridShift;
// Added to a number and taken away again it leaves the nearest whole one; halves go to the even one.
inline constexpr double kToWhole = 0x1.8p52;
inline constexpr double kLargestGrid = 0x1p36;  // coordinates beyond it must not be used

// Edges are drawn a tile at a time, with a vector lane for each of its rows.
inline constexpr std::int32_t kTileWidthShift = 5, kTileHeightShift = 3;
inline constexpr std::int32_t kTileWidth = 1 << kTileWidthShift,
                              kTileHeight = 1 << kTileHeightShift;  // pixels

// The size of a buffer, pixels; at most 8192 each.
struct EdgeBuffer {
  std::int32_t width = 0, height = 0;
};

// How x changes along an edge.
enum class EdgeSlope : std::uint8_t {
  kSteep,  // by at most 256 pixels a row, so that single precision can follow from row to row
  kFlat,
  kLevel,  // not with y
};

// Lengths are in 256ths of a pixel unless they say otherwise. Rows and tiles are those of the buffer.
struct BoundaryEdge {
  // Corners may be off by less than this.
  static constexpr std::int32_t kMargin = 1;
  // So far to the left or right of the buffer nothing matters, and places are moved there.
  static constexpr std::int32_t kBeyond = 1 << 20;

  // Where its line crosses the lower border of the tiles of first_row. A level edge crosses none: this is its
  // y.
  double x;
  double slope;       // change of x with y; 0 for a level edge
  float left, right;  // of what it may touch
  // Beyond where it crosses the borders of a row, along the row, it may touch pixels so far.
  float reach_left, reach_right;
  // So near to the edge, along the middle of a row, or of a level edge upwards and downwards, it is unknown
  // on which side a pixel's centre is: see "The pixel" in docs/conservative.md.
  float doubt;
  // The same in rows that it does not cross from border to border. There a swept edge may move over a point
  // of the pixel that lies on the inner side of its line, though the way to it from the centre, on the outer
  // side, met no more than the line beyond the edge's end. So that is all pixels that the line may meet.
  float end_doubt;
  std::int32_t bottom, top;                 // of the edge, moved into the buffer
  std::int16_t first_row, last_row;         // that it may touch
  std::int16_t first_crossed, end_crossed;  // whose middle it crosses
  std::int16_t first_whole, end_whole;      // that it crosses from border to border
  std::int16_t first_tile, last_tile;       // columns of tiles that it may touch; -1: left of the buffer
  EdgeSlope kind;
  bool falls, rightwards;  // from its first point to its second one
  bool matters;            // it does not lie above, below or to the right of the buffer

  // Whether it may touch some of the rows of tiles from `first` to `last`.
  bool touches(std::int32_t first, std::int32_t last) const {
    return first_row < (last + 1) * kTileHeight && last_row >= first * kTileHeight;
  }
  // Places farther away from a buffer are moved to where it does not matter either.
  static double within(double x, const EdgeBuffer& buffer) {
    return std::min(std::max(x, -double{kBeyond}), buffer.width * double{kGridStep} + kBeyond);
  }
  // Whether the winding is greater to the right of it, if the surface lies to its left `value` times. Of a
  // level edge this is a convention.
  bool rises(std::int32_t value) const { return falls == (value > 0); }
};

// Edges of a group's boundary. The surface lies to their left, `value` times.
struct BoundaryChain {
  std::uint32_t first = 0, count = 0;  // into a list of edges
  std::int32_t value = 0;              // not 0
};

// Edges are prepared in vectors of so many at most, which may be read from any edge of a list on.
inline constexpr std::size_t kMostLanes = 8;

// Makes room for so many numbers in each of the lists, and for whole vectors of them.
inline void makeRoomInLanes(std::size_t count, std::initializer_list<std::vector<double>*> lists) {
  for (std::vector<double>* list : lists) {
    if (list->size() < count + kMostLanes) {
      list->resize(2 * count + kMostLanes);
    }
  }
}

// Lines from one point to another, by coordinate.
struct GridLines {
  std::vector<double> from_x{}, from_y{}, to_x{}, to_y{};  // as in GridPoint

  void reserve(std::size_t count) { makeRoomInLanes(count, {&from_x, &from_y, &to_x, &to_y}); }
  void set(std::size_t i, const GridPoint& from, const GridPoint& to) {
    from_x[i] = from.x;
    from_y[i] = from.y;
    to_x[i] = to.x;
    to_y[i] = to.y;
  }
};

// How far lines are swept as the eye moves through a ViewerRegion, in 256ths of a pixel, at least 0. Each is
// a bound for all that the line is swept over, as far as that is in the buffer.
struct GridSweeps {
  // How far that reaches beyond the rectangle around the line.
  std::vector<double> left{}, right{}, down{}, up{};
  // How far it reaches, along a row, to either side of the straight line through both ends; not used of level
  // lines.
  std::vector<double> left_of_line{}, right_of_line{};

  static constexpr double kInfinite = 4.0 * kLargestGrid;  // from any line to the buffer, and beyond it

  void reserve(std::size_t count) {
    makeRoomInLanes(count, {&left, &right, &down, &up, &left_of_line, &right_of_line});
  }
};

// Prepares the first lines, one for each of `edges`. sweeps: of these lines; null: they stay where they are.
// Every instruction set gives the same bits.
void prepareEdges(const GridLines& lines, const GridSweeps* sweeps, const EdgeBuffer& buffer,
                  std::span<BoundaryEdge> edges);

}  // namespace sightline::occlusion
