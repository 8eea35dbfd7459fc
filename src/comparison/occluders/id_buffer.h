#pragma once

// A picture with ids: which occluder is the nearest in each pixel.

#include <cstdint>
#include <vector>

#include "src/comparison/occluders/occluder_picture.h"

namespace sightline::comparison {

inline constexpr std::uint32_t kNoOccluder = 0xffffffffu;

// The nearest of the occluders that were drawn, by number in an OccluderPicture; of equal ones the first.
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
