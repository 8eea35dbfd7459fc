#pragma once

// The finer depth buffers of a view: where they are drawn, and what they hide.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/culling/culling_method.h"
#include "sightline/culling/depth_pyramid_method.h"
#include "sightline/occluders/choose_occluders.h"
#include "sightline/occlusion/depth_pyramid.h"
#include "sightline/occlusion/rasteriser.h"
#include "src/culling/doubt_memory.h"
#include "src/culling/focus_budget.h"
#include "src/culling/focus_choice.h"
#include "src/culling/focus_window.h"
#include "src/culling/methods/surface_drawing.h"
#include "src/occlusion/boxes/pixel_boxes.h"

namespace sightline::culling {

// An object is in doubt if the depth buffer of the view does not hide its box, in a few pixels only. Where
// many such pixels are, windows are drawn with finer pixels. If each pixel in which the box may show lies in
// a window whose buffer hides the box there, the object is hidden.
//
// What is in doubt is found once the view has been culled, so windows lie where they are needed in this very
// view, and their occluders are those that it keeps.
class FocusMaps {
 public:
  // width, height: of the view's depth buffer, pixels. coherent: what windows showed of objects in earlier
  // views decides which ones are looked at. Otherwise all are, in each view.
  FocusMaps(const FocusSettings& settings, const CullingScene& scene, std::uint32_t width,
            std::uint32_t height, bool coherent);

  // A view begins: it has no windows yet.
  void begin();
  // A view that was culled by its own depth buffer.
  struct CulledView {
    const DepthPyramid& buffer;
    const CullingFrame& frame;
    const SurfaceDrawer& surfaces;
    double surface_work = 0.0;   // of the surfaces in the buffer
    const CullStats& traversal;  // which found the visible objects
    bool changes_fast = false;   // many of them are new
  };
  // Removes those of the visible objects that finer buffers hide.
  void refine(const CulledView& view, std::vector<ObjectId>& visible);
  // Sets the answers for those boxes to kHidden that the windows of refine() hide, where the middle of their
  // rectangle is in a window.
  void classify(const DepthPyramid& buffer, std::span<const Box> boxes, std::span<BoxAnswer> answers);

  // In the last view.
  std::uint32_t windows() const { return window_count_; }
  std::uint32_t hidden() const { return hidden_; }

 private:
  // What the windows say of a box.
  enum class Sight : std::uint8_t {
    kHidden,
    kSeen,     // in some pixel that is in a window, it is not surely hidden
    kUnknown,  // some pixel in which it may show is in no window
  };
  // An object in doubt.
  struct Doubt {
    std::uint32_t at = 0;                            // its index in the list of visible objects
    std::uint32_t first_pixel = 0, pixel_count = 0;  // in pixels_: those in which it may show
  };

  // all: not only among objects that windows hid before.
  void findDoubts(const DepthPyramid& buffer, std::span<const ObjectId> visible, bool all);
  void projectAll(const View& view, std::span<const ObjectId> visible);
  void drawWindows(const CullingFrame& frame, const SurfaceDrawer& surfaces,
                   std::span<const ObjectId> visible);
  // Draws surfaces until the work of all that is drawn is so much. Returns the work.
  double draw(FocusWindow& window, const CullingFrame& frame, const SurfaceDrawer& surfaces,
              std::span<const ObjectId> visible, double budget);
  // Returns the work.
  double drawOccluders(const FocusWindow& window, const CullingFrame& frame, bool choose_more);
  void removeHidden(std::vector<ObjectId>& visible);
  // Reorders the pixels.
  Sight lookAt(const Box& box, std::span<BufferPixel> pixels);
  std::span<const FocusWindow> windowsDrawn() const { return std::span(windows_).first(window_count_); }
  std::span<BufferPixel> pixelsOf(const Doubt& doubt) {
    return std::span(pixels_).subspan(doubt.first_pixel, doubt.pixel_count);
  }

  FocusSettings settings_;
  CullingScene scene_;
  std::uint32_t width_, height_;
  bool coherent_;
  Rasteriser raster_;  // draws one window after the other
  FocusChoice choice_;
  FocusBudget budget_;
  DoubtMemory memory_;
  std::vector<FocusWindow> windows_;
  std::uint32_t window_count_ = 0;  // the first ones of windows_ are drawn in this view
  std::uint32_t hidden_ = 0;        // objects that windows hid in this view
  std::uint32_t search_views_ = 1;  // views from one search among all objects to the next
  std::uint32_t search_in_ = 0;     // views before the next one

  // Scratch for one view; sized by the objects that a view keeps.
  std::vector<Doubt> doubts_;  // ascending by `at`
  std::vector<BufferPixel> pixels_;
  std::vector<Box> boxes_;
  std::vector<std::uint32_t> asked_, counts_;
  std::vector<occlusion::PixelBox> images_;  // of all visible objects, once a window is placed
  std::vector<ObjectId> shown_;              // objects that may appear in a window
  std::vector<occlusion::PixelRange> ranges_;
  OccluderChooser chooser_;
  std::vector<OccluderId> chosen_;
};

}  // namespace sightline::culling
