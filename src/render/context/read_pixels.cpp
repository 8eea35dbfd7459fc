#include "src/render/context/read_pixels.h"

#include <algorithm>
#include <cstddef>

namespace sightline::render {

Image readPixels(const Framebuffer& framebuffer) {
  Image image{.width = framebuffer.width, .height = framebuffer.height, .rgba = {}};
  const std::size_t row = std::size_t{4} * image.width;
  image.rgba.resize(row * image.height);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.id);
  glReadPixels(0, 0, static_cast<GLsizei>(image.width), static_cast<GLsizei>(image.height), GL_RGBA,
               GL_UNSIGNED_BYTE, image.rgba.data());
  for (std::size_t top = 0, bottom = image.height - 1; top < bottom; ++top, --bottom) {
    std::swap_ranges(image.rgba.data() + top * row, image.rgba.data() + (top + 1) * row,
                     image.rgba.data() + bottom * row);
  }
  return image;
}

Image halved(const Image& image) {
  Image half{.width = image.width / 2, .height = image.height / 2, .rgba = {}};
  half.rgba.resize(std::size_t{4} * half.width * half.height);
  const std::size_t row = std::size_t{4} * image.width;
  std::size_t out = 0;
  for (std::size_t y = 0; y < half.height; ++y) {
    for (std::size_t x = 0; x < half.width; ++x) {
      const std::uint8_t* in = image.rgba.data() + 2 * y * row + 8 * x;
      for (std::size_t c = 0; c < 4; ++c) {
        half.rgba[out++] =
            static_cast<std::uint8_t>((in[c] + in[c + 4] + in[row + c] + in[row + c + 4] + 2) / 4);
      }
    }
  }
  return half;
}

}  // namespace sightline::render
