// Blur by depth: each pixel adds a disc of its own size. A chord changes a row of differences at its two ends
// only, and each row is summed once at the end.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <vector>

#include "sightline/render/depth_of_field.h"
#include "src/render/lens/blur_area.h"
#include "src/render/lens/blur_disc.h"

namespace sightline {

using namespace render;

namespace {

// Opacity below this is the rounding of differences.
constexpr double kNothing = 1e-9;

class DepthBlur {
 public:
  DepthBlur(const LayerImage& image, const View& view, const Lens& lens)
      : image_(image), view_(view), lens_(lens), painted_(paintedArea(image)) {}

  void run(Spread spread, LayerImage& blurred) {
    if (painted_.empty()) {
      return;
    }
    target_ = grown(painted_, largestReach(painted_), image_);
    differences_.assign(static_cast<std::size_t>(target_.height()) * rowLength(), {});
    const PixelArea all = grownBeyondBorders(painted_, borderReach(), image_);
    for (int y = all.y0; y < all.y1; ++y) {
      for (int x = all.x0; x < all.x1; ++x) {
        add(x, y);
      }
    }
    finish(spread, blurred);
  }

 private:
  using Sum = std::array<double, 4>;

  std::size_t rowLength() const { return static_cast<std::size_t>(target_.width()) + 2; }

  double diameterAt(int x, int y) const {
    const auto column = static_cast<std::size_t>(std::clamp(x, 0, static_cast<int>(image_.width) - 1));
    const auto row = static_cast<std::size_t>(std::clamp(y, 0, static_cast<int>(image_.height) - 1));
    const double depth = static_cast<double>(image_.depths[row * image_.width + column]);
    return std::clamp(circleOfConfusion(view_, lens_, depth, image_.height), 1.0, largestBlur(image_));
  }

  // The farthest that the disc of any pixel in the area reaches, in pixels.
  int largestReach(const PixelArea& area) const {
    double largest = 1.0;
    for (int y = area.y0; y < area.y1; ++y) {
      for (int x = area.x0; x < area.x1; ++x) {
        if (pixelAt(image_, x, y) != ShapedPixel{}) {
          largest = std::max(largest, diameterAt(x, y));
        }
      }
    }
    return static_cast<int>(0.5 * largest) + 1;
  }

  int borderReach() const {
    const int width = static_cast<int>(image_.width), height = static_cast<int>(image_.height);
    return std::max({largestReach({0, 0, width, 1}), largestReach({0, height - 1, width, height}),
                     largestReach({0, 0, 1, height}), largestReach({width - 1, 0, width, height})});
  }

  void add(int x, int y) {
    const ShapedPixel pixel = pixelAt(image_, x, y);
    if (pixel == ShapedPixel{}) {
      return;
    }
    const double diameter = diameterAt(x, y);
    if (diameter != diameter_) {
      setDiameter(disc_, diameter);
      diameter_ = diameter;
    }
    const double scale = 1.0 / disc_.area;
    const Sum value{scale * static_cast<double>(pixel.red), scale * static_cast<double>(pixel.green),
                    scale * static_cast<double>(pixel.blue), scale * static_cast<double>(pixel.alpha)};
    const int last = std::min(y + disc_.reach(), target_.y1) - 1;
    for (int row = std::max(y - disc_.reach() + 1, target_.y0); row <= last; ++row) {
      addChord(row, x + 0.5, disc_.half_chords[static_cast<std::size_t>(std::abs(row - y))], value);
    }
  }

  void addChord(int row, double middle, double half, const Sum& value) {
    const double width = target_.width();
    const double from = std::clamp(middle - half - target_.x0, 0.0, width);
    const double to = std::clamp(middle + half - target_.x0, 0.0, width);
    Sum* sums = &differences_[static_cast<std::size_t>(row - target_.y0) * rowLength()];
    addEnd(sums, from, value, 1.0);
    addEnd(sums, to, value, -1.0);
  }

  // Adds `value` to the row from position `at` on; the pixel that contains `at` gets its share.
  static void addEnd(Sum* sums, double at, const Sum& value, double sign) {
    const auto pixel = static_cast<std::size_t>(at);
    const double next = at - static_cast<double>(pixel);
    for (std::size_t c = 0; c < value.size(); ++c) {
      sums[pixel][c] += sign * (1.0 - next) * value[c];
      sums[pixel + 1][c] += sign * next * value[c];
    }
  }

  void finish(Spread spread, LayerImage& blurred) const {
    for (int y = target_.y0; y < target_.y1; ++y) {
      const Sum* difference = &differences_[static_cast<std::size_t>(y - target_.y0) * rowLength()];
      ShapedPixel* out =
          &blurred.pixels[static_cast<std::size_t>(y) * blurred.width + static_cast<std::size_t>(target_.x0)];
      Sum sum{};
      for (int x = target_.x0; x < target_.x1; ++x, ++difference, ++out) {
        for (std::size_t c = 0; c < sum.size(); ++c) {
          sum[c] += (*difference)[c];
        }
        if (sum[3] <= kNothing) {
          continue;
        }
        const double scale = spread == Spread::kNormalised ? 1.0 / sum[3] : 1.0;
        *out = {static_cast<float>(scale * sum[0]), static_cast<float>(scale * sum[1]),
                static_cast<float>(scale * sum[2]), static_cast<float>(scale * sum[3])};
      }
    }
  }

  const LayerImage& image_;
  const View& view_;
  const Lens& lens_;
  PixelArea painted_, target_;
  BlurDisc disc_;
  double diameter_ = 0.0;         // of disc_, which is kept because neighbours often have the same
  std::vector<Sum> differences_;  // width + 2 for each row: a chord may end on the border
};

}  // namespace

void blurByDepth(const LayerImage& image, const View& view, const Lens& lens, Spread spread,
                 LayerImage& blurred) {
  if (image.depths.empty()) {
    blurEvenly(image, 0.0, blurred);
    return;
  }
  blurred.clear(image.width, image.height);
  DepthBlur(image, view, lens).run(spread, blurred);
}

}  // namespace sightline
