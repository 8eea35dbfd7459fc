#include "sightline/io/image.h"

#include <png.h>

#include "failure.h"
#include "sightline/io/file.h"

namespace sightline {

Status writePng(const Image& image, const std::string& file) {
  if (image.width == 0 || image.height == 0 ||
      image.rgba.size() != std::size_t{4} * image.width * image.height) {
    return failure("{}: a picture of {} x {} pixels cannot have {} bytes", file, image.width, image.height,
                   image.rgba.size());
  }
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = image.width;
  png.height = image.height;
  png.format = PNG_FORMAT_RGBA;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::string bytes(size, '\0');
  const int written = png_image_write_to_memory(&png, bytes.data(), &size, 0, image.rgba.data(), 0, nullptr);
  if (written == 0) {
    return failure("{}: cannot be encoded as PNG: {}", file, png.message);
  }
  bytes.resize(size);
  return writeFile(file, bytes);
}

}  // namespace sightline
