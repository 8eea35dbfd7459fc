#include "src/comparison/occluders/id_buffer.h"

namespace sightline::comparison {

void IdBuffer::clear(const OccluderPicture& picture) {
  index_.assign(picture.pixelCount(), kNoOccluder);
  reciprocal_depth_.assign(picture.pixelCount(), 0.0f);
  pixels_of_.assign(picture.occluders().size(), 0);
  survivors_ = 0;
}

void IdBuffer::draw(const OccluderPicture& picture, std::uint32_t index) {
  picture.forEachPixel(index, [&](std::uint32_t pixel, float reciprocal_depth) {
    if (!(reciprocal_depth > reciprocal_depth_[pixel])) {
      return;
    }
    const std::uint32_t before = index_[pixel];
    if (before != kNoOccluder && --pixels_of_[before] == 0) {
      --survivors_;
    }
    index_[pixel] = index;
    reciprocal_depth_[pixel] = reciprocal_depth;
    if (++pixels_of_[index] == 1) {
      ++survivors_;
    }
  });
}

}  // namespace sightline::comparison
