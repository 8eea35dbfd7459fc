#pragma once

// The chains of surfaces as edges in a depth buffer.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/occluders/surface_set.h"
#include "src/occlusion/boundary_edge.h"
#include "src/scene/pixel_view.h"

namespace sightline::occlusion {

// Prepares each chain when it is first asked for in a view. Equal points of the scene have equal images.
class ChainEdges {
 public:
  // Makes room for the chains of a set, so that begin() need not.
  void reserve(const SurfaceSet& set);
  // clip_depth: camera space; what is nearer is left out.
  void begin(const SurfaceSet& set, const PixelView& view, double clip_depth, const EdgeBuffer& buffer);

  // Appends a chain to a group's boundary: those of its edges that matter to the buffer, or what is left of
  // them beyond the clip depth.
  void add(std::uint32_t chain, std::int32_t value, std::vector<BoundaryChain>& boundary) {
    Image& image = images_[chain];
    if (image.view != number_) {
      prepare(chain, image);
    }
    if (image.count > 0) {
      boundary.push_back({image.first, image.count, value});
    }
  }
  // The same for the line along which the clip plane cuts a triangle of the set, if it does. The part of the
  // triangle beyond the plane is the surface.
  void addCut(std::span<const std::uint32_t, 3> triangle, std::int32_t value,
              std::vector<BoundaryChain>& boundary);
  // What was added since begin().
  std::span<const BoundaryEdge> edges() const { return edges_; }

 private:
  struct Image {
    std::uint32_t view = 0;              // number of the view for which it holds
    std::uint32_t first = 0, count = 0;  // into edges_
  };
  void prepare(std::uint32_t chain, Image& image);
  void addEdge(const GridPoint& from, const GridPoint& to);
  Vec3d toCamera(const Vec3f& point) const { return view_.toCamera(Vec3d(point) - view_.eye); }
  GridPoint pixelOf(const Vec3d& camera) const;
  GridPoint cutPoint(const Vec3f& a, const Vec3f& b) const;

  const SurfaceSet* set_ = nullptr;
  PixelView view_;
  double clip_depth_ = 0.0;
  EdgeBuffer buffer_;
  std::uint32_t number_ = 0;
  std::vector<Image> images_;  // by chain of the largest set
  std::vector<BoundaryEdge> edges_;
};

}  // namespace sightline::occlusion
