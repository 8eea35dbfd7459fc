#pragma once

// Where boxes lie in a depth buffer into which surfaces are drawn, and how far away they are.

#include <span>
#include <vector>

#include "sightline/math/box.h"
#include "sightline/math/plane.h"
#include "src/occlusion/boxes/pixel_boxes.h"
#include "src/occlusion/surfaces/depth_target.h"
#include "src/scene/pixel_view.h"

namespace sightline::occlusion {

// The image of a box.
struct BoxExtent {
  double nearest = 0.0, farthest = 0.0;  // depths, metres
  bool cut = false;                      // it reaches the depth at which surfaces are clipped
  bool inexact = false;                  // nothing can be told of its image
  bool among_viewers = false;            // something of it may be too near to one of the viewers
  PixelRectangle rectangle;
};

class BoxExtents {
 public:
  // bounds: all boxes lie in these.
  void begin(const scene::PixelView& view, const Box& bounds, const DepthTarget& target);
  const scene::PixelView& view() const { return view_; }
  // What surfaces nearer than this depth do is left out, metres.
  double clipDepth() const { return clip_depth_; }

  // Projects boxes, for the first form of of(). There may be more images than boxes.
  void project(std::span<const Box> boxes, std::vector<PixelBox>& images) const;
  // False: outside the view, or its image cannot be computed exactly enough. What lies beyond the far plane
  // is outside too: it may be left out of a surface, but not out of the depth of one.
  bool of(const Box& box, const PixelBox& image, BoxExtent& extent) const;
  bool of(const Box& box, BoxExtent& extent) const;
  // The reciprocal depth of its nearest point beyond the clip depth, rounded up.
  float nearestOf(const BoxExtent& extent) const;

  // Whether all of a slab is farther from all viewers than what is too near to one of them. thickness: before
  // the plane.
  bool clearOfViewers(const Plane& support, double thickness) const;

 private:
  void setViewers();
  double tooNear() const;

  scene::PixelView view_;
  DepthTarget target_;
  double clip_depth_ = 0.0;
  // The box around all places in camera space that are too near to one of several viewers; empty if there is
  // one.
  Vec3d viewers_min_, viewers_max_;
  BoxProjection projection_;
  bool batches_ = false;  // projection_ is exact enough for all boxes
};

}  // namespace sightline::occlusion
