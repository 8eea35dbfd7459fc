#pragma once

// Culling several views at once: the one of a frame, and those that its camera is expected to have next.

#include <cstdint>

#include "sightline/occlusion/rasteriser.h"
#include "sightline/scene/camera.h"
#include "sightline/scene/viewer_region.h"

namespace sightline::culling {

class ViewsToCome {
 public:
  // most: views at once; with 1 there is nothing to plan.
  explicit ViewsToCome(std::uint32_t most);

  // A frame begins with this view, as makeUsable() leaves it.
  void see(const View& view);
  // Whether what was planned for an earlier frame holds for this one, too; then it does for one frame less.
  bool takeHeld();
  // Plans for this frame and the next ones, from how the camera came from the last frame to this one. False:
  // no view can be found for several frames, or the camera moves too fast.
  bool plan();
  // A view that shows at least as much as the views planned for, and where their eyes may be.
  const View& wide() const { return wide_; }
  const ViewerRegion& viewers() const { return viewers_; }
  // Whether all that is hidden in wide() from all of viewers() is hidden in this view, too.
  bool contain(const View& view) const;

  // What was planned counts for no further frame.
  void end() { left_ = 0; }
  // The next frame follows none.
  void forget();
  // Learns from the depth buffer of a view how near things are.
  void measure(const View& view, const DepthBufferView& buffer);

 private:
  // The part of a picture that a view takes up, in the axes of wide_: directions whose x / z and y / z are
  // between these; and the z of those that are 1 long along the view's own axis.
  struct Extent {
    double low_x, high_x, low_y, high_y, low_z, high_z;
    bool in_front;  // all of it lies before the eye

    void join(const Extent& other);
  };

  std::uint32_t count() const;
  Vec3d toWide(const Vec3d& v) const {
    return {dot(wide_.right, v), dot(wide_.up, v), dot(wide_.forward, v)};
  }
  Extent extentOf(const View& view) const;
  bool widen(double by);
  double backFor(const Vec3d& eye) const;

  std::uint32_t most_, left_ = 0;  // frames for which what was planned may still hold
  View last_, view_;               // of the last two frames
  std::uint32_t seen_ = 0;         // how many of them there were
  double pixels_a_metre_ = 0.0;    // see measure()

  View wide_;
  ViewerRegion viewers_;
  Extent shown_{};     // of wide_
  Vec3d first_, end_;  // the eyes are within spread_ of the line between these
  double spread_ = 0.0;
};

}  // namespace sightline::culling
