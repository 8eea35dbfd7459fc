#pragma once

// Where the chains of surfaces lie in a depth buffer.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/occluders/surface_set.h"
#include "src/occlusion/winding_map.h"
#include "src/scene/pixel_view.h"

namespace sightline::occlusion {

struct GridSegment {
  GridPoint from, to;
};

// Projects each chain when it is first asked for in a view. Equal points of the scene have equal images.
class ChainPoints {
 public:
  // clip_depth: metres; what is nearer is left out.
  void begin(const SurfaceSet& set, const PixelView& view, double clip_depth);

  struct Edges {
    std::span<const GridPoint> points;
    std::uint32_t step;  // 1: edges from each point to the next one; 2: only every second of them
  };
  // The images of a chain's edges, or of what is left of them beyond the clip depth; valid until the next
  // call.
  Edges edges(std::uint32_t chain) {
    Image& image = images_[chain];
    if (image.view != number_) {
      project(chain, image);
    }
    return {std::span(points_).subspan(image.first, image.count), image.clipped ? 2u : 1u};
  }

  // The line along which the clip plane cuts a triangle of the set. False: there is none. The part beyond the
  // plane lies to its left, as seen from the triangle's front.
  bool cut(std::span<const std::uint32_t, 3> triangle, GridSegment& line) const;

 private:
  struct Image {
    std::uint32_t view = 0;              // number of the view for which it holds
    std::uint32_t first = 0, count = 0;  // into points_
    bool clipped = false;  // two points for each edge that is left; otherwise the chain's vertices
  };
  void project(std::uint32_t chain, Image& image);
  Vec3d toCamera(const Vec3f& point) const { return view_.toCamera(Vec3d(point) - view_.eye); }
  GridPoint pixelOf(const Vec3d& camera) const;
  GridPoint cutPoint(const Vec3f& a, const Vec3f& b) const;

  const SurfaceSet* set_ = nullptr;
  PixelView view_;
  double clip_depth_ = 0.0;
  std::uint32_t number_ = 0;
  std::vector<Image> images_;  // by chain of the largest set
  std::vector<GridPoint> points_;
};

}  // namespace sightline::occlusion
