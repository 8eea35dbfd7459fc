#include "tools/sightline/report/depth_legend.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

namespace sightline::tool {
namespace {

// Lengths in units of a letter's pixels, which are squares of some pixels of the picture.
constexpr std::uint32_t kGlyphWidth = 5, kGlyphHeight = 7;
constexpr std::uint32_t kAdvance = kGlyphWidth + 1;  // from one letter to the next
constexpr std::uint32_t kMargin = 5, kBar = 8, kBetweenBars = 2, kTick = 3, kAboveText = 2;
constexpr std::uint32_t kUnitWidth = 480;  // pixels of the picture for each pixel of a unit

constexpr DepthColor kPaper{255, 255, 255}, kInk{27, 31, 36};

// The rows of each letter from above; the leftmost pixel is the highest of five bits.
struct Glyph {
  char letter;
  std::uint8_t rows[kGlyphHeight];
};
constexpr Glyph kGlyphs[] = {
    {'0', {0x0e, 0x11, 0x13, 0x15, 0x19, 0x11, 0x0e}}, {'1', {0x04, 0x0c, 0x04, 0x04, 0x04, 0x04, 0x0e}},
    {'2', {0x0e, 0x11, 0x01, 0x02, 0x04, 0x08, 0x1f}}, {'3', {0x1f, 0x02, 0x04, 0x02, 0x01, 0x11, 0x0e}},
    {'4', {0x02, 0x06, 0x0a, 0x12, 0x1f, 0x02, 0x02}}, {'5', {0x1f, 0x10, 0x1e, 0x01, 0x01, 0x11, 0x0e}},
    {'6', {0x06, 0x08, 0x10, 0x1e, 0x11, 0x11, 0x0e}}, {'7', {0x1f, 0x01, 0x02, 0x04, 0x08, 0x08, 0x08}},
    {'8', {0x0e, 0x11, 0x11, 0x0e, 0x11, 0x11, 0x0e}}, {'9', {0x0e, 0x11, 0x11, 0x0f, 0x01, 0x02, 0x0c}},
    {'.', {0x00, 0x00, 0x00, 0x00, 0x00, 0x0c, 0x0c}}, {'k', {0x10, 0x10, 0x12, 0x14, 0x18, 0x14, 0x12}},
    {'m', {0x00, 0x00, 0x1a, 0x15, 0x15, 0x11, 0x11}}};

class Strip {
 public:
  Strip(Image& image, std::uint32_t top, std::uint32_t unit) : image_(image), top_(top), unit_(unit) {}

  // Fills a rectangle of pixels; y counts from the top of the strip. What lies outside the picture is left
  // out.
  void fill(std::uint32_t x, std::uint32_t y, std::uint32_t width, std::uint32_t height,
            const DepthColor& color) {
    for (std::uint32_t row = top_ + y; row < std::min(top_ + y + height, image_.height); ++row) {
      for (std::uint32_t column = x; column < std::min(x + width, image_.width); ++column) {
        std::uint8_t* pixel = &image_.rgba[4 * (std::size_t{row} * image_.width + column)];
        std::copy(color.begin(), color.end(), pixel);
        pixel[3] = 255;
      }
    }
  }

  std::uint32_t widthOf(std::string_view text) const {
    return (static_cast<std::uint32_t>(text.size()) * kAdvance - 1) * unit_;
  }

  void write(std::uint32_t x, std::uint32_t y, std::string_view text) {
    for (const char letter : text) {
      for (const Glyph& glyph : kGlyphs) {
        for (std::uint32_t row = 0; glyph.letter == letter && row < kGlyphHeight; ++row) {
          for (std::uint32_t column = 0; column < kGlyphWidth; ++column) {
            if ((glyph.rows[row] >> (kGlyphWidth - 1 - column) & 1) != 0) {
              fill(x + column * unit_, y + row * unit_, unit_, unit_, kInk);
            }
          }
        }
      }
      x += kAdvance * unit_;
    }
  }

 private:
  Image& image_;
  std::uint32_t top_, unit_;
};

// The ticks, with the text of those that have room for it, the ends of the scale first.
class DepthAxis {
 public:
  DepthAxis(Strip& strip, const DepthScale& scale, std::uint32_t left, std::uint32_t width,
            std::uint32_t unit)
      : strip_(strip), scale_(scale), left_(left), width_(width), unit_(unit) {}

  void draw(std::uint32_t y) {
    add(y, scale_.nearest);
    add(y, scale_.farthest);
    for (const double tick : ticksOf(scale_)) {
      add(y, tick);
    }
  }

 private:
  struct Span {
    std::uint32_t begin, end;
  };

  void add(std::uint32_t y, double metres) {
    const std::string text = depthText(metres);
    const std::uint32_t length = strip_.widthOf(text);
    const auto at = left_ + static_cast<std::uint32_t>(std::lround(scale_.place(metres) * (width_ - unit_)));
    strip_.fill(at, y, unit_, kTick * unit_, kInk);
    const std::uint32_t most = left_ + width_ > length ? left_ + width_ - length : 0;
    const std::uint32_t begin =
        std::clamp(at > length / 2 ? at - length / 2 : 0, std::min(left_, most), most);
    const std::uint32_t gap = 2 * kAdvance * unit_;
    for (const Span& taken : taken_) {
      if (begin < taken.end + gap && taken.begin < begin + length + gap) {
        return;
      }
    }
    taken_.push_back({begin, begin + length});
    strip_.write(begin, y + (kTick + kAboveText) * unit_, text);
  }

  Strip& strip_;
  DepthScale scale_;
  std::uint32_t left_, width_, unit_;
  std::vector<Span> taken_;  // by texts, in pixels
};

}  // namespace

std::string depthText(double metres) {
  const bool kilo = metres >= 9999.5;
  const double value = kilo ? metres / 1000.0 : metres;
  const int decimals = value >= 9.95 || value == std::floor(value) ? 0 : value >= 0.995 ? 1 : 2;
  return fmt::format("{:.{}f} {}", value, decimals, kilo ? "km" : "m");
}

Image withDepthLegend(const Image& picture, const DepthScale& scale,
                      std::span<const std::span<const DepthColor>> ramps) {
  const std::uint32_t unit = std::max(1u, picture.width / kUnitWidth);
  const auto bars = static_cast<std::uint32_t>(ramps.size());
  const std::uint32_t below_bars = kMargin + bars * (kBar + kBetweenBars) - kBetweenBars;
  const std::uint32_t height = (below_bars + kTick + kAboveText + kGlyphHeight + kMargin) * unit;
  Image image{picture.width, picture.height + height, picture.rgba};
  image.rgba.resize(std::size_t{4} * image.width * image.height);
  Strip strip(image, picture.height, unit);
  strip.fill(0, 0, image.width, height, kPaper);
  const std::uint32_t left = std::min(kMargin * unit, image.width / 4), width = image.width - 2 * left;
  for (std::uint32_t bar = 0; bar < bars; ++bar) {
    for (std::uint32_t x = 0; x < width; ++x) {
      strip.fill(left + x, (kMargin + bar * (kBar + kBetweenBars)) * unit, 1, kBar * unit,
                 colorAt(ramps[bar], static_cast<double>(x) / std::max(1u, width - 1)));
    }
  }
  DepthAxis(strip, scale, left, width, unit).draw(below_bars * unit);
  return image;
}

}  // namespace sightline::tool
