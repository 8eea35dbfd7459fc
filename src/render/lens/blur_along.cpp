// Blur along a line by a kernel of the pixels near the line.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "sightline/render/depth_of_field.h"
#include "src/render/lens/blur_area.h"

namespace sightline {

using namespace render;

namespace {

struct Tap {
  int dx = 0, dy = 0;
  float weight = 0.0f;
};

// The weights of pixels near a line: each point of the line is shared out to the four pixels around it with
// bilinear weights. Between two grid lines of pixel centres a weight is a polynomial of degree 2 along the
// line, which Simpson's rule integrates exactly.
class LineKernel {
 public:
  LineKernel(double dx, double dy) : dx_(dx), dy_(dy) {
    reach_x_ = static_cast<int>(std::ceil(0.5 * std::abs(dx))) + 1;
    reach_y_ = static_cast<int>(std::ceil(0.5 * std::abs(dy))) + 1;
    shares_.assign(static_cast<std::size_t>(2 * reach_x_ + 1) * static_cast<std::size_t>(2 * reach_y_ + 1),
                   0.0);
    std::vector<double> cuts{0.0, 1.0};
    addCuts(dx, cuts);
    addCuts(dy, cuts);
    std::sort(cuts.begin(), cuts.end());
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
      addStretch(cuts[i], cuts[i + 1]);
    }
  }

  int reach() const { return std::max(reach_x_, reach_y_); }

  std::vector<Tap> taps() const {
    std::vector<Tap> taps;
    auto share = shares_.begin();
    for (int y = -reach_y_; y <= reach_y_; ++y) {
      for (int x = -reach_x_; x <= reach_x_; ++x, ++share) {
        if (*share > 0.0) {
          taps.push_back({x, y, static_cast<float>(*share)});
        }
      }
    }
    return taps;
  }

 private:
  // Adds the shares in [0, 1] of the line at which a coordinate that runs from -d / 2 to d / 2 is an integer.
  static void addCuts(double d, std::vector<double>& cuts) {
    const double half = 0.5 * std::abs(d);
    for (double whole = std::ceil(-half); whole <= half && half > 0.0; whole += 1.0) {
      cuts.push_back(std::clamp((whole + half) / (2.0 * half), 0.0, 1.0));
    }
  }

  void addStretch(double from, double to) {
    const double middle = 0.5 * (from + to);
    const int cell_x = static_cast<int>(std::floor((middle - 0.5) * dx_));
    const int cell_y = static_cast<int>(std::floor((middle - 0.5) * dy_));
    for (const auto& [at, weight] : {std::pair{from, 1.0}, {middle, 4.0}, {to, 1.0}}) {
      const double x = (at - 0.5) * dx_ - cell_x, y = (at - 0.5) * dy_ - cell_y;
      const double share = (to - from) * weight / 6.0;
      add(cell_x, cell_y, share * (1.0 - x) * (1.0 - y));
      add(cell_x + 1, cell_y, share * x * (1.0 - y));
      add(cell_x, cell_y + 1, share * (1.0 - x) * y);
      add(cell_x + 1, cell_y + 1, share * x * y);
    }
  }

  void add(int x, int y, double share) {
    const auto row = static_cast<std::size_t>(y + reach_y_), column = static_cast<std::size_t>(x + reach_x_);
    shares_[row * static_cast<std::size_t>(2 * reach_x_ + 1) + column] += share;
  }

  double dx_, dy_;
  int reach_x_ = 0, reach_y_ = 0;
  std::vector<double> shares_;
};

void addScaled(const ShapedPixel* row, int count, float weight, ShapedPixel* out) {
  for (int i = 0; i < count; ++i) {
    out[i].red += weight * row[i].red;
    out[i].green += weight * row[i].green;
    out[i].blue += weight * row[i].blue;
    out[i].alpha += weight * row[i].alpha;
  }
}

void spreadAlong(const LayerImage& image, const LineKernel& kernel, LayerImage& blurred) {
  const PixelArea painted = paintedArea(image);
  if (painted.empty()) {
    return;
  }
  const PixelArea source = grownBeyondBorders(painted, kernel.reach(), image);
  const PixelArea target = grown(painted, kernel.reach(), image);
  const std::vector<Tap> taps = kernel.taps();
  std::vector<ShapedPixel> row(static_cast<std::size_t>(source.width()));
  for (int y = source.y0; y < source.y1; ++y) {
    for (int x = source.x0; x < source.x1; ++x) {
      row[static_cast<std::size_t>(x - source.x0)] = pixelAt(image, x, y);
    }
    for (const Tap& tap : taps) {
      const int to = y + tap.dy;
      const int x0 = std::max(source.x0 + tap.dx, target.x0), x1 = std::min(source.x1 + tap.dx, target.x1);
      if (to >= target.y0 && to < target.y1 && x0 < x1) {
        addScaled(
            &row[static_cast<std::size_t>(x0 - tap.dx - source.x0)], x1 - x0, tap.weight,
            &blurred.pixels[static_cast<std::size_t>(to) * blurred.width + static_cast<std::size_t>(x0)]);
      }
    }
  }
}

}  // namespace

void blurAlong(const LayerImage& image, double dx, double dy, LayerImage& blurred) {
  const double length = std::hypot(dx, dy);
  if (!std::isfinite(length) || length == 0.0) {
    blurEvenly(image, 0.0, blurred);
    return;
  }
  const double scale = std::min(1.0, largestBlur(image) / length);
  blurred.clear(image.width, image.height);
  spreadAlong(image, LineKernel(scale * dx, scale * dy), blurred);
}

}  // namespace sightline
