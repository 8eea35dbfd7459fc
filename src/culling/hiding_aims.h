#pragma once

// What surfaces are drawn for in a view that follows another one: boxes that they are to hide.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/base/ids.h"
#include "sightline/math/box.h"
#include "src/culling/doubt_memory.h"

namespace sightline::culling {

// Most of what could be drawn hides nothing that other surfaces do not hide as well. So surfaces are drawn
// for boxes: first for those that the last view hid, then for what is not hidden by that. All objects that
// have come into view are aimed at, and now and then kept ones that may be hidden by now. Work for them adds
// up over the views until it is worth while.
class HidingAims {
 public:
  // So many boxes that were hidden in the last view are enough.
  static constexpr std::size_t kMaxHiddenBoxes = 128;

  // bounds: of all objects; they must outlive this.
  explicit HidingAims(std::span<const Box> bounds = {}) : bounds_(bounds), tried_(bounds.size()) {}

  // A view begins. There is nothing to be hidden yet. jumped: it has nothing to do with the last one.
  void beginView(bool jumped);
  // Aims at boxes that the last view hid, and at objects that it hid.
  void aimAtHidden(std::span<const Box> boxes, std::span<const ObjectId> objects);
  // Aims instead at objects that the depth buffer shows: at all that are new since the last view, and in some
  // views at others. drawn: work that was done in this view; left: work that may be done. Returns the work
  // that may be done for them, at most `left`, or 0 if that is to wait.
  std::uint32_t aimAtShown(std::span<const ObjectId> shown, std::span<const ObjectId> news, double drawn,
                           std::uint32_t left);
  // What is to be hidden.
  std::span<const Box> boxes() const { return boxes_; }
  // The view ends. kept, news: objects that the depth buffer shows, and those of them that are new,
  // ascending. Those that were aimed at in vain are left alone for a while.
  void endView(std::span<const ObjectId> kept, std::span<const ObjectId> news);

 private:
  // Kept objects that may be hidden by now are aimed at in one of so many views, or when some are new.
  static constexpr std::uint32_t kViewsBetweenTries = 4;
  // So much is drawn for each new object, and for each of the other ones.
  static constexpr double kWorkForNew = 50.0, kWorkForTry = 25.0;
  // All of that is saved up until it is more than kMinShare of what was drawn before in the view. Then at
  // most kMaxShare of what was drawn is spent, or kMinCap if that is more; as much again may be left to later
  // views.
  static constexpr double kMinShare = 1.5, kMaxShare = 2.0, kMinCap = 2000.0;

  void append(std::span<const ObjectId> objects);

  std::span<const Box> bounds_;
  std::vector<Box> boxes_;
  DoubtMemory tried_;  // kept objects that were aimed at
  std::vector<ObjectId> aimed_at_;
  std::uint32_t views_ = 0;
  double saved_work_ = 0.0;
};

}  // namespace sightline::culling
