#pragma once

// What became of the objects that were in doubt in earlier views.

#include <algorithm>
#include <cstdint>
#include <vector>

#include "sightline/base/ids.h"

namespace sightline::culling {

// An object that was hidden when more was drawn for it, in a finer depth buffer say, is likely to be hidden
// again. One that could be seen all the same rests, for longer each time: some views pass before it is looked
// at again.
template <typename Id>
class DoubtsOf {
 public:
  static constexpr std::uint32_t kCertain = 256;

  // objects: 0: it remembers nothing, and every object is as one that was never looked at. view: the number
  // of the view before the first one; after the largest number comes 0.
  explicit DoubtsOf(std::size_t objects, std::uint32_t view = 0)
      : objects_(objects, Past{view}), view_(view) {}

  // There are so many objects by now, if that is more; new ones were never looked at. room: as many as there
  // is to be room for.
  void grow(std::size_t objects, std::size_t room) {
    if (objects > objects_.size()) {
      objects_.reserve(room);
      objects_.resize(objects, Past{view_});
    }
  }

  void beginView() { ++view_; }

  // What was last looked at before as many views as there are numbers may rest once more.
  bool rests(Id object) const { return of(object).rests_until - view_ - 1 < kMaxRest; }
  // Whether a finer buffer hid the object when it was last looked at.
  bool wasHidden(Id object) const { return of(object).halvings == 0; }
  // How likely a finer buffer hides the object, at most kCertain.
  std::uint32_t chance(Id object) const { return kCertain >> of(object).halvings; }

  // The object shows in many pixels, so no finer buffer hides it.
  void showsClearly(Id object) { set(object, kClearRest, std::max(of(object).halvings, kUntried)); }
  void hidden(Id object) { set(object, 0, 0); }
  // The object is one that was never looked at.
  void forget(Id object) { set(object, 0, kUntried); }
  // A finer buffer did not hide the object.
  void seen(Id object) {
    const std::uint32_t halvings = std::min(of(object).halvings + 1, kMaxHalvings);
    set(object, 1u << halvings, halvings);
  }

 private:
  static constexpr std::uint32_t kUntried = 1, kMaxHalvings = 7;  // of the chance
  static constexpr std::uint32_t kSpread = 8;                     // views by which rests differ
  static constexpr std::uint32_t kClearRest = 20;                 // views
  static constexpr std::uint32_t kMaxRest = (1u << kMaxHalvings) + kSpread;

  struct Past {
    std::uint32_t rests_until = 0;  // the last view in which the object rests
    std::uint32_t halvings = kUntried;
  };

  Past of(Id object) const { return objects_.empty() ? Past{view_} : objects_[object.value]; }
  // Rests differ in length, so that objects that came into view together are not all looked at in one view.
  void set(Id object, std::uint32_t rest, std::uint32_t halvings) {
    if (!objects_.empty()) {
      const std::uint32_t spread = rest > 0 ? object.value % kSpread : 0;
      objects_[object.value] = {view_ + rest + spread, halvings};
    }
  }

  std::vector<Past> objects_;
  std::uint32_t view_;
};

using DoubtMemory = DoubtsOf<ObjectId>;

}  // namespace sightline::culling
