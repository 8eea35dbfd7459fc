#pragma once

// Whether a map is nearer than a box at every pixel of a rectangle, looking at few of its pixels.

#include <cstdint>
#include <vector>

#include "sightline/occlusion/rasteriser.h"
#include "src/occlusion/pixel_boxes.h"

namespace sightline::occlusion {

// Both ways of comparing give the same answer: true where every covered pixel of the rectangle, which lies in
// the map, is nearer than the box's nearest point, and not as near. Uncovered pixels are left out: whether
// they may be there at all is for the overlap test to say.

// Pixel by pixel, row by row up to the first that is not nearer. compared: goes up by the pixels looked at.
bool allNearerPixelwise(const DepthMapView& map, const PixelBox& rect, std::uint64_t& compared);

// The sparse depth map of Poon and Wang 1999, section 5.3: for each pixel the distance to the next peak on
// its right, a pixel that is locally the farthest of its row. Between two peaks depth falls and then rises,
// so that no pixel between two others is farther than both: the first pixel of a rectangle, the peaks in it
// and its last pixel will do.
//
// Making a row costs as much as comparing it pixel by pixel several times in vector code. So rows are made
// when they have been asked about that much, and those without coverage never are. Rows, and whole maps, of
// too many peaks are compared pixel by pixel, as are narrow rectangles.
class SparseDepth {
 public:
  // Maps that follow one with too many peaks and are not made.
  static constexpr std::uint32_t kRest = 15;

  // Another map. It must outlive the questions. Allocates for maps larger than all before only.
  void begin(const DepthMapView& map);

  bool allNearer(const PixelBox& rect);

  // False where the map before had too many peaks, and this one is compared pixel by pixel.
  bool worthwhile() const { return rest_ == 0; }
  // Of this map: peaks were looked up.
  bool used() const { return used_; }
  // Of this map: pixels looked at.
  std::uint64_t compared() const { return compared_; }

 private:
  enum class RowState : std::uint8_t { kNotMade, kSteps, kTooManyPeaks };
  struct Row {
    std::uint32_t compared = 0;  // pixels, before it was made
    RowState state = RowState::kNotMade;
  };

  RowState stateOf(std::uint32_t y, std::uint32_t asked);
  void makeRow(std::uint32_t y);
  bool nearerAtPeaks(const PixelBox& rect, std::uint32_t y);

  DepthMapView map_;
  std::vector<std::uint16_t> steps_;  // to the next peak or the row's end, pixels; as many as the map has
  std::vector<Row> rows_;
  std::uint64_t made_ = 0, peaks_ = 0;  // of this map: pixels of rows that were made, peaks in them
  std::uint32_t rest_ = 0;              // maps still to be left out, this one included
  bool used_ = false;
  std::uint64_t compared_ = 0;
};

}  // namespace sightline::occlusion
