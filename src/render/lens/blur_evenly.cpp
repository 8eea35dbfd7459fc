// Even blur: a chord's sum is the difference of two prefix sums of its row, so its length costs nothing.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "sightline/render/depth_of_field.h"
#include "src/render/lens/blur_area.h"
#include "src/render/lens/blur_disc.h"

namespace sightline {

using namespace render;

namespace {

constexpr std::size_t kChannels = 4;

class EvenBlur {
 public:
  EvenBlur(const LayerImage& image, double diameter, LayerImage& blurred) : image_(image), blurred_(blurred) {
    setDiameter(disc_, diameter);
    const PixelArea painted = paintedArea(image);
    if (!painted.empty()) {
      source_ = grownBeyondBorders(painted, disc_.reach(), image);
      target_ = grown(painted, disc_.reach(), image);
    }
  }

  void run() {
    if (source_.empty()) {
      return;
    }
    // The row reaches beyond the target's ends as far as a chord does, so that no chord needs to be clamped.
    first_ = target_.x0 - disc_.reach() - 1;
    const int width = target_.x1 + disc_.reach() + 1 - first_;
    row_.assign(kChannels * static_cast<std::size_t>(width), 0.0);
    sums_.assign(row_.size() + kChannels, 0.0);
    chords_.resize(kChannels * static_cast<std::size_t>(target_.width()));
    for (int y = source_.y0; y < source_.y1; ++y) {
      readRow(y);
      for (int dy = 0; dy < disc_.reach(); ++dy) {
        const bool up = inTarget(y - dy), down = dy > 0 && inTarget(y + dy);
        if (up || down) {
          sumChords(disc_.half_chords[static_cast<std::size_t>(dy)]);
        }
        if (up) {
          addTo(y - dy);
        }
        if (down) {
          addTo(y + dy);
        }
      }
    }
  }

 private:
  bool inTarget(int y) const { return y >= target_.y0 && y < target_.y1; }

  // Reads the row's pixels and computes their prefix sums.
  void readRow(int y) {
    std::array<double, kChannels> sum{};
    const int end = first_ + static_cast<int>(row_.size() / kChannels);
    std::size_t i = 0;
    for (int x = first_; x < end; ++x) {
      const bool inside = x >= source_.x0 && x < source_.x1;
      const ShapedPixel pixel = inside ? pixelAt(image_, x, y) : ShapedPixel{};
      for (const float value : {pixel.red, pixel.green, pixel.blue, pixel.alpha}) {
        row_[i] = value;
        sum[i % kChannels] += value;
        sums_[i + kChannels] = sum[i % kChannels];
        ++i;
      }
    }
  }

  // Sets chords_ to the sums over a chord around each pixel of the target's width, divided by the disc's
  // area. half is half the chord's length in pixels.
  void sumChords(double half) {
    const auto whole =
        static_cast<std::size_t>(std::lround(half));  // distance to the pixel that contains the chord's end
    const double part = whole == 0 ? half : half + 0.5 - static_cast<double>(whole);
    const double scale = 1.0 / disc_.area;
    const auto middle = kChannels * static_cast<std::size_t>(target_.x0 - first_);
    const std::size_t away = kChannels * whole;
    const double* low = &row_[middle - away];
    const double* high = &row_[middle + away];
    if (whole == 0) {
      for (std::size_t i = 0; i < chords_.size(); ++i) {
        chords_[i] = static_cast<float>(scale * part * (low[i] + high[i]));
      }
      return;
    }
    const double* before = &sums_[middle - away + kChannels];
    const double* upto = &sums_[middle + away];
    for (std::size_t i = 0; i < chords_.size(); ++i) {
      chords_[i] = static_cast<float>(scale * (part * (low[i] + high[i]) + (upto[i] - before[i])));
    }
  }

  void addTo(int y) {
    ShapedPixel* out =
        &blurred_.pixels[static_cast<std::size_t>(y) * blurred_.width + static_cast<std::size_t>(target_.x0)];
    for (std::size_t i = 0; i < chords_.size(); i += kChannels, ++out) {
      out->red += chords_[i];
      out->green += chords_[i + 1];
      out->blue += chords_[i + 2];
      out->alpha += chords_[i + 3];
    }
  }

  const LayerImage& image_;
  LayerImage& blurred_;
  BlurDisc disc_;
  PixelArea source_, target_;
  int first_ = 0;                   // the column of row_'s first pixel
  std::vector<double> row_, sums_;  // four numbers for each pixel
  std::vector<float> chords_;
};

}  // namespace

void blurEvenly(const LayerImage& image, double diameter, LayerImage& blurred) {
  if (!(diameter > 1.0)) {
    blurred.width = image.width;
    blurred.height = image.height;
    blurred.pixels = image.pixels;
    blurred.depths.clear();
    return;
  }
  blurred.clear(image.width, image.height);
  EvenBlur(image, std::min(diameter, largestBlur(image)), blurred).run();
}

}  // namespace sightline
