#include "sightline/io/layer_file.h"

#include <algorithm>
#include <cstddef>
#include <exception>
#include <set>
#include <utility>

#include "sightline/io/file.h"
#include "src/io/failure.h"

#ifdef SIGHTLINE_OPENEXR
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>
#endif

namespace sightline {

using namespace io;

namespace {

constexpr std::uint32_t kMaxPixels = 1u << 15;

Status checkLayer(const std::string& file, const FileLayer& layer, std::uint32_t width,
                  std::uint32_t height) {
  const std::size_t pixels = std::size_t{layer.width} * layer.height;
  if (layer.left > width || layer.width > width - layer.left || layer.top > height ||
      layer.height > height - layer.top) {
    return failure("{}: the layer {} is not within the picture of {} x {} pixels", file, layer.name, width,
                   height);
  }
  if (layer.rgba.size() != 4 * pixels || (!layer.depths.empty() && layer.depths.size() != pixels)) {
    return failure("{}: the layer {} of {} x {} pixels cannot have {} colours and {} depths", file,
                   layer.name, layer.width, layer.height, layer.rgba.size(), layer.depths.size());
  }
  return Success{};
}

Status check(const std::string& file, std::uint32_t width, std::uint32_t height,
             std::span<const FileLayer> layers) {
  if (width == 0 || height == 0 || width > kMaxPixels || height > kMaxPixels || layers.empty()) {
    return failure("{}: {} layers of {} x {} pixels cannot be written", file, layers.size(), width, height);
  }
  std::set<std::string> names;
  for (const FileLayer& layer : layers) {
    if (const Status ok = checkLayer(file, layer, width, height); !ok) {
      return ok;
    }
    if (!names.insert(layer.name).second) {
      return failure("{}: two layers have the name {}", file, layer.name);
    }
  }
  return Success{};
}

}  // namespace

FileLayer croppedLayer(std::string name, std::uint32_t width, std::uint32_t height,
                       std::span<const float> rgba, std::span<const float> depths) {
  FileLayer layer{.name = std::move(name)};
  std::uint32_t left = width, right = 0, top = height, bottom = 0;
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      const float* const p = &rgba[4 * (std::size_t{y} * width + x)];
      if (p[0] != 0.0f || p[1] != 0.0f || p[2] != 0.0f || p[3] != 0.0f) {
        left = std::min(left, x), right = std::max(right, x + 1);
        top = std::min(top, y), bottom = y + 1;
      }
    }
  }
  if (left >= right) {
    return layer;
  }
  layer.left = left, layer.width = right - left;
  layer.top = top, layer.height = bottom - top;
  for (std::uint32_t y = top; y < bottom; ++y) {
    const std::size_t begin = std::size_t{y} * width + left;
    const auto colors = rgba.subspan(4 * begin, 4 * std::size_t{layer.width});
    layer.rgba.insert(layer.rgba.end(), colors.begin(), colors.end());
    if (!depths.empty()) {
      const auto own = depths.subspan(begin, layer.width);
      layer.depths.insert(layer.depths.end(), own.begin(), own.end());
    }
  }
  return layer;
}

#ifdef SIGHTLINE_OPENEXR

namespace {

// Collects what OpenEXR writes, so that a file is written whole or not at all.
class ByteStream : public Imf::OStream {
 public:
  explicit ByteStream(const std::string& file) : Imf::OStream(file.c_str()) {}

  void write(const char* bytes, int count) override {
    const auto size = static_cast<std::size_t>(count);
    bytes_.resize(std::max(bytes_.size(), at_ + size));
    std::copy(bytes, bytes + count, bytes_.begin() + static_cast<std::ptrdiff_t>(at_));
    at_ += size;
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t position) override { at_ = position; }

  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

// A layer's pixels as OpenEXR takes them: it knows no empty rectangles, so a transparent layer has one pixel.
const FileLayer& pixelsOf(const FileLayer& layer) {
  static const FileLayer kOnePixel{.width = 1, .height = 1, .rgba = {0, 0, 0, 0}};
  return layer.rgba.empty() ? kOnePixel : layer;
}

Imath::Box2i windowOf(const FileLayer& layer) {
  const Imath::V2i from(static_cast<int>(layer.left), static_cast<int>(layer.top));
  const Imath::V2i size(static_cast<int>(layer.width), static_cast<int>(layer.height));
  return {from, from + size - Imath::V2i(1, 1)};
}

Imf::Header headerOf(const FileLayer& layer, std::uint32_t width, std::uint32_t height) {
  const Imath::Box2i whole({0, 0}, {static_cast<int>(width) - 1, static_cast<int>(height) - 1});
  Imf::Header header(whole, windowOf(pixelsOf(layer)));
  header.compression() = Imf::ZIP_COMPRESSION;
  header.setName(layer.name);
  header.setType(Imf::SCANLINEIMAGE);
  for (const char* const channel : {"R", "G", "B", "A"}) {
    header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
  }
  if (!layer.depths.empty()) {
    header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
  }
  return header;
}

void writePart(Imf::MultiPartOutputFile& output, int part, const FileLayer& asked) {
  const FileLayer& layer = pixelsOf(asked);
  Imf::OutputPart out(output, part);
  const Imath::Box2i window = windowOf(layer);
  Imf::FrameBuffer buffer;
  std::size_t first = 0;
  for (const char* const channel : {"R", "G", "B", "A"}) {
    buffer.insert(channel, Imf::Slice::Make(Imf::FLOAT, layer.rgba.data() + first++, window,
                                            4 * sizeof(float), 4 * sizeof(float) * layer.width));
  }
  if (!layer.depths.empty()) {
    buffer.insert("Z", Imf::Slice::Make(Imf::FLOAT, layer.depths.data(), window, sizeof(float),
                                        sizeof(float) * layer.width));
  }
  out.setFrameBuffer(buffer);
  out.writePixels(static_cast<int>(layer.height));
}

}  // namespace

Status writeLayerFile(const std::string& file, std::uint32_t width, std::uint32_t height,
                      std::span<const FileLayer> layers, const std::string& description) {
  if (const Status ok = check(file, width, height, layers); !ok) {
    return ok;
  }
  ByteStream stream(file);
  try {
    std::vector<Imf::Header> headers;
    for (const FileLayer& layer : layers) {
      headers.push_back(headerOf(layer, width, height));
    }
    headers.front().insert("sightline", Imf::StringAttribute(description));
    Imf::MultiPartOutputFile output(stream, headers.data(), static_cast<int>(headers.size()));
    for (std::size_t i = 0; i < layers.size(); ++i) {
      writePart(output, static_cast<int>(i), layers[i]);
    }
  } catch (const std::exception& error) {
    return failure("{}: cannot be written as OpenEXR: {}", file, error.what());
  }
  return writeFile(file, stream.bytes());
}

#else

Status writeLayerFile(const std::string& file, std::uint32_t width, std::uint32_t height,
                      std::span<const FileLayer> layers, const std::string& description) {
  (void)description;
  if (const Status ok = check(file, width, height, layers); !ok) {
    return ok;
  }
  return failure("{}: this build has no OpenEXR; install its development files and configure again", file);
}

#endif

}  // namespace sightline
