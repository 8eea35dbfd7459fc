#include "sightline/io/image.h"

#include <png.h>

#include "sightline/io/file.h"
#include "src/io/failure.h"

namespace sightline {

using namespace io;

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

Result<Image> readPng(const std::string& file) {
  constexpr std::uint32_t kMaxPixels = 16384;
  const Result<std::string> bytes = readFile(file);
  if (!bytes) {
    return bytes.error();
  }
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_memory(&png, bytes->data(), bytes->size()) == 0) {
    return failure("{}: cannot be read as PNG: {}", file, png.message);
  }
  if (png.width > kMaxPixels || png.height > kMaxPixels) {
    const Error error = failure("{}: has {} x {} pixels; at most {} a side can be read", file, png.width,
                                png.height, kMaxPixels);
    png_image_free(&png);
    return error;
  }
  png.format = PNG_FORMAT_RGBA;
  Image image{.width = png.width, .height = png.height, .rgba = {}};
  image.rgba.resize(PNG_IMAGE_SIZE(png));
  if (png_image_finish_read(&png, nullptr, image.rgba.data(), 0, nullptr) == 0) {
    return failure("{}: cannot be read as PNG: {}", file, png.message);
  }
  return image;
}

}  // namespace sightline
