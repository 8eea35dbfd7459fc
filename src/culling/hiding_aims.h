#pragma once

// What surfaces are drawn for in a view that follows another one: boxes that they are to hide.

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "sightline/base/ids.h"
#include "sightline/math/box.h"
#include "src/culling/doubt_memory.h"
#include "src/culling/last_view.h"

namespace sightline::culling {

// Most of what could be drawn hides nothing that other surfaces do not hide as well. So surfaces are drawn
// for boxes: first for those that the last view hid, then for what is not hidden by that. All objects that
// have come into view are aimed at, and now and then kept ones that may be hidden by now. Work for them adds
// up over the views until it is worth while.
template <typename Id>
class HidingAims {
 public:
  // So many boxes that were hidden in the last view are enough.
  static constexpr std::size_t kMaxHiddenBoxes = 128;

  explicit HidingAims(std::size_t objects = 0) : tried_(objects) {}
  // There are so many objects by now, if that is more. room: as many as there is to be room for.
  void grow(std::size_t objects, std::size_t room) { tried_.grow(objects, room); }

  // A view begins. There is nothing to be hidden yet. jumped: it has nothing to do with the last one.
  void beginView(bool jumped) {
    tried_.beginView();
    // Little is drawn after a jump, so that the next view is one in which kept objects are aimed at.
    views_ = jumped ? kViewsBetweenTries - 1 : views_ + 1;
    saved_work_ = jumped ? 0.0 : saved_work_;
    boxes_.clear();
    aimed_at_.clear();
  }

  // Aims at boxes that the last view hid, and at objects that it hid. box_of: returns the box of an object.
  template <typename BoxOf>
  void aimAtHidden(std::span<const Box> boxes, std::span<const Id> objects, const BoxOf& box_of) {
    boxes_.assign(boxes.begin(), boxes.end());
    append(objects, box_of);
  }

  // Aims instead at objects that the depth buffer shows: at all that are new since the last view, and in some
  // views at others. drawn: work that was done in this view; left: work that may be done. Returns the work
  // that may be done for them, at most `left`, which is all of it where most is new, or 0 if that is to wait.
  template <typename BoxOf>
  std::uint32_t aimAtShown(std::span<const Id> shown, std::span<const Id> news, double drawn,
                           std::uint32_t left, const BoxOf& box_of) {
    aimed_at_.reserve(shown.size());
    aimed_at_.assign(news.begin(), news.end());
    if (!news.empty() || views_ % kViewsBetweenTries == 0) {
      for (const Id object : shown) {
        if (!tried_.rests(object) && !std::binary_search(news.begin(), news.end(), object)) {
          aimed_at_.push_back(object);
        }
      }
    }
    const auto tries = static_cast<double>(aimed_at_.size() - news.size());
    saved_work_ += kWorkForNew * static_cast<double>(news.size()) + kWorkForTry * tries;
    const double most = std::max(kMaxShare * drawn, kMinCap);
    // Where most is new, what was drawn says little of what is worth it.
    const auto worth =
        mostIsNew(news.size(), shown.size())
            ? left
            : static_cast<std::uint32_t>(std::min({saved_work_, most, static_cast<double>(left)}));
    if (aimed_at_.empty() || saved_work_ <= kMinShare * drawn || worth == 0) {
      aimed_at_.clear();
      return 0;
    }
    saved_work_ = std::clamp(saved_work_ - worth, 0.0, most);
    boxes_.clear();
    boxes_.reserve(shown.size());
    append(std::span<const Id>(aimed_at_), box_of);
    return worth;
  }

  // What is to be hidden.
  std::span<const Box> boxes() const { return boxes_; }
  // The objects that aimAtShown() aims at, where it says that work may be done for them.
  std::span<const Id> aimedAt() const { return aimed_at_; }

  // The view ends. kept, news: objects that the depth buffer shows, and those of them that are new,
  // ascending. Those that were aimed at in vain are left alone for a while.
  void endView(std::span<const Id> kept, std::span<const Id> news) {
    for (const Id object : news) {
      tried_.forget(object);
    }
    for (const Id object : aimed_at_) {
      if (std::binary_search(kept.begin(), kept.end(), object)) {
        tried_.seen(object);
      }
    }
  }

 private:
  // Kept objects that may be hidden by now are aimed at in one of so many views, or when some are new.
  static constexpr std::uint32_t kViewsBetweenTries = 4;
  // So much is drawn for each new object, and for each of the other ones.
  static constexpr double kWorkForNew = 50.0, kWorkForTry = 25.0;
  // All of that is saved up until it is more than kMinShare of what was drawn before in the view. Then at
  // most kMaxShare of what was drawn is spent, or kMinCap if that is more; as much again may be left to later
  // views.
  static constexpr double kMinShare = 1.5, kMaxShare = 2.0, kMinCap = 2000.0;

  template <typename BoxOf>
  void append(std::span<const Id> objects, const BoxOf& box_of) {
    for (const Id object : objects) {
      boxes_.push_back(box_of(object));
    }
  }

  std::vector<Box> boxes_;
  DoubtsOf<Id> tried_;  // kept objects that were aimed at
  std::vector<Id> aimed_at_;
  std::uint32_t views_ = 0;
  double saved_work_ = 0.0;
};

// Calls use(i) for `most` numbers below `all`, or for all of them. Where there are more, they are spread over
// all of them, others in each turn.
template <typename Use>
void spreadOver(std::size_t all, std::size_t most, std::size_t turn, const Use& use) {
  const std::size_t count = std::min(most, all);
  for (std::size_t i = 0; i < count; ++i) {
    use((i * all / count + turn) % all);
  }
}

}  // namespace sightline::culling
