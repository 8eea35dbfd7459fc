#pragma once

// What became of the objects that were in doubt in earlier views.

#include <algorithm>
#include <cstdint>
#include <vector>

#include "sightline/base/ids.h"

namespace sightline::culling {

// An object that a finer depth buffer hid is likely to be hidden by one again, and attracts windows. One that
// could be seen in it all the same rests, for longer each time: some views pass before it is looked at again.
// Two bytes an object.
class DoubtMemory {
 public:
  static constexpr std::uint32_t kCertain = 256;

  explicit DoubtMemory(std::size_t objects) : objects_(objects) {}

  void beginView() { ++view_; }

  bool rests(ObjectId object) const {
    return static_cast<std::uint8_t>(objects_[object.value].until - view_ - 1) < kLongestRest;
  }
  // Whether a finer buffer hid the object when it was last looked at.
  bool wasHidden(ObjectId object) const { return objects_[object.value].halvings == 0; }
  // How likely a finer buffer hides the object, at most kCertain.
  std::uint32_t chance(ObjectId object) const { return kCertain >> objects_[object.value].halvings; }

  // It can be seen in many pixels.
  void clear(ObjectId object) { rest(object, kClearRest); }
  void hidden(ObjectId object) { objects_[object.value] = {view_, 0}; }
  // A finer buffer did not hide it.
  void seen(ObjectId object) {
    std::uint8_t& halvings = objects_[object.value].halvings;
    halvings = static_cast<std::uint8_t>(std::min(halvings + 1, kMostHalvings));
    rest(object, 2u << halvings);
  }

 private:
  static constexpr std::uint8_t kLongestRest = 100;  // views
  static constexpr std::uint32_t kClearRest = 20;    // views; up to 7 are added
  static constexpr int kMostHalvings = 5;

  struct Doubt {
    std::uint8_t until = 0;     // the last view in which it rests, modulo 256
    std::uint8_t halvings = 1;  // of the chance
  };

  // The lengths differ, so that objects that came into view together are not all looked at in one view.
  void rest(ObjectId object, std::uint32_t views) {
    objects_[object.value].until = static_cast<std::uint8_t>(view_ + views + (object.value & 7));
  }

  std::vector<Doubt> objects_;
  std::uint8_t view_ = 0;
};

}  // namespace sightline::culling
