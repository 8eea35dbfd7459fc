#pragma once

// What became of the objects that were in doubt in earlier views.

#include <algorithm>
#include <cstdint>
#include <vector>

#include "sightline/base/ids.h"

namespace sightline::culling {

// An object that a finer depth buffer hid is likely to be hidden by one again, and attracts windows. One that
// could be seen in it all the same rests, for longer each time: some views pass before it is looked at again.
// Four bytes an object.
class DoubtMemory {
 public:
  static constexpr std::uint32_t kCertain = 256;

  explicit DoubtMemory(std::size_t objects) : objects_(objects) {}

  void beginView() {
    if (++view_ == kLastView) {
      objects_.assign(objects_.size(), Doubt{});
      view_ = 0;
    }
  }

  bool rests(ObjectId object) const { return objects_[object.value].until > view_; }
  // Whether a finer buffer hid the object when it was last looked at.
  bool wasHidden(ObjectId object) const { return objects_[object.value].halvings == 0; }
  // How likely a finer buffer hides the object, at most kCertain.
  std::uint32_t chance(ObjectId object) const { return kCertain >> objects_[object.value].halvings; }

  // It can be seen in many pixels.
  void clear(ObjectId object) { rest(object, kClearRest); }
  void hidden(ObjectId object) { objects_[object.value] = {0, 0}; }
  // A finer buffer did not hide it.
  void seen(ObjectId object) {
    const std::uint32_t halvings = std::min(objects_[object.value].halvings + 1u, kMostHalvings);
    objects_[object.value].halvings = halvings & kMostHalvings;
    rest(object, 1u << halvings);
  }

 private:
  static constexpr std::uint32_t kClearRest = 20;                // views; up to 7 are added
  static constexpr std::uint32_t kMostHalvings = 7;              // what three bits can hold
  static constexpr std::uint32_t kLastView = (1u << 29) - 1000;  // far less than all bits of `until`

  struct Doubt {
    std::uint32_t until : 29 = 0;    // the last view in which it rests
    std::uint32_t halvings : 3 = 1;  // of the chance
  };

  // The lengths differ, so that objects that came into view together are not all looked at in one view.
  void rest(ObjectId object, std::uint32_t views) {
    objects_[object.value].until = (view_ + views + (object.value & 7)) & ((1u << 29) - 1);
  }

  std::vector<Doubt> objects_;
  std::uint32_t view_ = 0;
};

}  // namespace sightline::culling
