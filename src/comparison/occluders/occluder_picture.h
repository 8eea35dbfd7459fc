#pragma once

// Pictures of occluders at a low resolution, sampled at pixel centres. They tell which pixels each occluder
// covers.
//
// Pixels and reciprocal depth are those of scene/pixel_view.h; pixel (x, y) has the index y * resolution + x.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/occluders/occluder_set.h"
#include "src/comparison/occluders/occluder_filter.h"
#include "src/geometry/centre_spans.h"
#include "src/scene/pixel_view.h"

namespace sightline::comparison {

inline constexpr std::uint32_t kMaxResolution = 512;

// A square perspective picture.
struct PictureShape {
  std::uint32_t resolution = 128;  // pixels along an edge
  double view_angle_deg = 100.0;   // from border to border
  double near = 0.1;               // metres
};

scene::PixelView pictureView(const Vec3d& eye, const Vec3d& forward, const PictureShape& shape);

// Pixels first to last of row y.
struct PixelSpan {
  std::uint16_t y = 0, first = 0, last = 0;
};

// An occluder as it lies in the picture.
struct ShownOccluder {
  OccluderId id;
  std::uint32_t first_span = 0, span_count = 0;
  std::uint32_t pixels = 0;  // whose centres it covers
  double area = 0.0;         // of its image, pixels
  // The reciprocal depth (1/w) at pixel coordinates (x, y) is at_origin + along_x * x + along_y * y.
  double at_origin = 0.0, along_x = 0.0, along_y = 0.0;
};

// Keeps its storage from picture to picture.
class OccluderPicture {
 public:
  // Draws the candidates that cover at least one pixel's centre and have an area of at least min_area pixels,
  // in the candidates' order. Every side that hides counts; parts in front of the near plane are cut off.
  void draw(const OccluderSet& set, std::span<const NearOccluder> candidates, const Vec3d& eye,
            const Vec3d& forward, const PictureShape& shape, double min_area);

  const scene::PixelView& view() const { return view_; }
  std::uint32_t resolution() const { return resolution_; }
  std::uint32_t pixelCount() const { return resolution_ * resolution_; }
  std::span<const ShownOccluder> occluders() const { return shown_; }

  // Calls body(pixel, reciprocal depth) for each pixel that occluder number `index` covers.
  template <typename Body>
  void forEachPixel(std::uint32_t index, Body&& body) const {
    const ShownOccluder& o = shown_[index];
    for (std::uint32_t s = o.first_span; s < o.first_span + o.span_count; ++s) {
      const PixelSpan& span = spans_[s];
      const double row = o.at_origin + o.along_y * (span.y + 0.5);
      for (std::uint32_t x = span.first; x <= span.last; ++x) {
        body(span.y * resolution_ + x, clampedReciprocalDepth(row + o.along_x * (x + 0.5)));
      }
    }
  }

 private:
  struct Corner {
    Vec3d position;  // camera space
  };
  bool inPicture(const Vec3d& center, double radius) const;
  void drawOne(const OccluderSet& set, const NearOccluder& candidate, double min_area);
  bool clip();
  // Always positive: its bits then sort like its value.
  float clampedReciprocalDepth(double reciprocal_depth) const {
    return static_cast<float>(
        reciprocal_depth < highest_ ? (reciprocal_depth > lowest_ ? reciprocal_depth : lowest_) : highest_);
  }

  scene::PixelView view_;
  std::uint32_t resolution_ = 0;
  double tan_half_ = 1.0, side_length_ = 1.0;  // of the half angle; of a side plane's normal
  double highest_ = 1.0, lowest_ = 1.0;        // reciprocal depth
  std::vector<ShownOccluder> shown_;
  std::vector<PixelSpan> spans_;
  std::vector<Corner> polygon_, scratch_;
  std::vector<geometry::PixelPoint> corners_px_;
};

}  // namespace sightline::comparison
