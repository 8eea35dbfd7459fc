#include "src/culling/focus_window.h"

#include <algorithm>
#include <cmath>

namespace sightline::culling {
namespace {

constexpr std::uint32_t kMaxCells = 64;  // along a side of the depth buffer
constexpr double kMinCosine = 0.1;       // between a window's corners and the viewing direction
constexpr double kMinTangent = 1e-6;     // of half a window's angle
constexpr double kNearMargin = 1.0 + 1e-6;

}  // namespace

FocusWindow::FocusWindow(const FocusSettings& settings, std::uint32_t width, std::uint32_t height)
    : settings_(settings), width_(width), height_(height) {
  while ((std::max(width, height) >> cell_shift_) > kMaxCells) {
    ++cell_shift_;
  }
  const std::uint32_t cell = 1u << cell_shift_;
  columns_ = (width + cell - 1) / cell;
  rows_ = (height + cell - 1) / cell;
  const auto cells = [&](std::uint32_t pixels, std::uint32_t max) {
    const double wanted = pixels / settings.magnification / cell;
    return std::clamp(static_cast<std::uint32_t>(std::min(wanted + 0.5, 1e6)), 1u, max);
  };
  window_columns_ = cells(settings.raster.width, columns_);
  window_rows_ = cells(settings.raster.height, rows_);
  counts_.assign((columns_ + 1) * (rows_ + 1), 0);
}

void FocusWindow::begin(const View& view, bool after_last) {
  Vec3d direction;
  found_ = after_last && !view.orthographic && findDirection(direction) && setWindow(view, direction);
  std::fill(counts_.begin(), counts_.end(), 0u);
  last_ = PixelView(view, width_, height_);
}

bool FocusWindow::findDirection(Vec3d& direction) {
  const std::uint32_t stride = columns_ + 1;
  for (std::uint32_t y = 1; y <= rows_; ++y) {
    std::uint32_t in_row = 0;
    for (std::uint32_t x = 1; x <= columns_; ++x) {
      in_row += counts_[y * stride + x];
      counts_[y * stride + x] = counts_[(y - 1) * stride + x] + in_row;
    }
  }
  std::uint32_t max_sum = 0, best_x = 0, best_y = 0;
  for (std::uint32_t y = 0; y + window_rows_ <= rows_; ++y) {
    const std::uint32_t *low = &counts_[y * stride], *high = low + window_rows_ * stride;
    for (std::uint32_t x = 0; x + window_columns_ <= columns_; ++x) {
      const std::uint32_t sum = high[x + window_columns_] - high[x] - low[x + window_columns_] + low[x];
      if (sum > max_sum) {
        max_sum = sum;
        best_x = x;
        best_y = y;
      }
    }
  }
  if (max_sum < settings_.min_objects) {
    return false;
  }
  const double cell = 1u << cell_shift_;
  const double x = (best_x + 0.5 * window_columns_) * cell, y = (best_y + 0.5 * window_rows_) * cell;
  direction = last_.unit_z + last_.unit_x * ((x - last_.middle_x) / last_.scale_x) +
              last_.unit_y * ((y - last_.middle_y) / last_.scale_y);
  return true;
}

bool FocusWindow::setWindow(const View& view, const Vec3d& direction) {
  const PixelView buffer(view, width_, height_);
  const double half_width = 0.5 * settings_.raster.width / settings_.magnification;
  const double half_height = 0.5 * settings_.raster.height / settings_.magnification;
  const double tan_x = half_width / buffer.scale_x, tan_y = half_height / buffer.scale_y;
  if (!(tan_x > kMinTangent && tan_y > kMinTangent)) {
    return false;
  }
  window_ = view;
  setOrientation(window_, direction, view.up);
  window_.shift_x = window_.shift_y = 0.0;
  window_.tan_half_fovy = tan_y;
  window_.aspect = tan_x / tan_y;
  tan_half_diagonal_ = std::sqrt(tan_x * tan_x + tan_y * tan_y);
  // Move the window's near plane beyond the view's own: geometry in front of that is not drawn and hides
  // nothing.
  double cosine = 1.0;
  for (const double sx : {-1.0, 1.0}) {
    for (const double sy : {-1.0, 1.0}) {
      const Vec3d corner = window_.forward + window_.right * (sx * tan_x) + window_.up * (sy * tan_y);
      const double of_corner = dot(corner, view.forward) / length(corner);
      if (!(of_corner > kMinCosine)) {
        return false;
      }
      cosine = std::min(cosine, of_corner);
    }
  }
  const Vec3d c = buffer.toCamera(window_.forward);
  if (!buffer.sane() || !(tan_half_diagonal_ < 1.0)) {
    return false;
  }
  window_.near = view.near / cosine * kNearMargin;
  window_.far = std::max(view.far, 2.0 * window_.near);
  const auto pixel = [](double at, std::uint32_t size) {
    return static_cast<std::uint16_t>(std::clamp(at, 0.0, size - 1.0));
  };
  x0_ = pixel(buffer.pixelX(c) - half_width, width_);
  x1_ = pixel(buffer.pixelX(c) + half_width, width_);
  y0_ = pixel(buffer.pixelY(c) - half_height, height_);
  y1_ = pixel(buffer.pixelY(c) + half_height, height_);
  return true;
}

bool FocusWindow::mayShow(const Box& box) const {
  const Vec3d to_center = center(box) - window_.eye;
  const double radius = 0.5 * length(Vec3d(box.max) - Vec3d(box.min));
  const double depth = dot(to_center, window_.forward);
  if (depth < -radius) {
    return false;
  }
  const double aside = std::sqrt(std::max(0.0, dot(to_center, to_center) - depth * depth));
  return aside <= std::max(depth, 0.0) * tan_half_diagonal_ + 1.5 * radius;
}

}  // namespace sightline::culling
