#pragma once

// A picture with ids: the nearest occluder of each pixel.

#include <cstdint>
#include <vector>

#include "src/comparison/occluders/occluder_picture.h"

namespace sightline::comparison {

inline constexpr std::uint32_t kNoOccluder = 0xffffffffu;

// Holds, for each pixel, the nearest of the occluders that were drawn, by its number in an OccluderPicture;
// of equally near ones the first.
class IdBuffer {
 public:
  void clear(const OccluderPicture& picture);
  void draw(const OccluderPicture& picture, std::uint32_t index);

  // kNoOccluder: none.
  std::uint32_t occluderAt(std::uint32_t pixel) const { return index_[pixel]; }
  float reciprocalDepthAt(std::uint32_t pixel) const { return reciprocal_depth_[pixel]; }  // 0: none
  // Pixels in which the occluder is the nearest.
  std::uint32_t pixelsOf(std::uint32_t index) const { return pixels_of_[index]; }
  // Occluders that are the nearest in at least one pixel.
  std::uint32_t survivors() const { return survivors_; }

 private:
  std::vector<std::uint32_t> index_;      // by pixel
  std::vector<float> reciprocal_depth_;   // by pixel
  std::vector<std::uint32_t> pixels_of_;  // by occluder
  std::uint32_t survivors_ = 0;
};

}  // namespace sightline::comparison
