#include "occluders/id_buffer.h"

namespace sightline::viewpoint_detail {

void IdBuffer::clear(const OccluderPicture& picture) {
  index_.assign(picture.pixelCount(), kNoOccluder);
  nearness_.assign(picture.pixelCount(), 0.0f);
  pixels_of_.assign(picture.occluders().size(), 0);
  survivors_ = 0;
}

void IdBuffer::draw(const OccluderPicture& picture, std::uint32_t index) {
  picture.forEachPixel(index, [&](std::uint32_t pixel, float nearness) {
    if (!(nearness > nearness_[pixel])) {
      return;
    }
    const std::uint32_t before = index_[pixel];
    if (before != kNoOccluder && --pixels_of_[before] == 0) {
      --survivors_;
    }
    index_[pixel] = index;
    nearness_[pixel] = nearness;
    if (++pixels_of_[index] == 1) {
      ++survivors_;
    }
  });
}

}  // namespace sightline::viewpoint_detail
