#pragma once

// What a view of a World hid: it is to be hidden in the next one, too.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sightline/math/box.h"
#include "src/culling/hiding_aims.h"
#include "src/world/world_data.h"

namespace sightline::world {

// Nodes of the hierarchy are known by their boxes, for they come and go as it is kept good. Instances are
// known by their ids, and their boxes are where they are now.
class HiddenBoxes {
 public:
  // A view begins that hides nothing so far.
  void begin(const WorldData& data) {
    nodes_.clear();
    instances_.clear();
    origin_ = data.origin;
    version_ = data.version;
  }
  void addNode(const Box& box) { nodes_.push_back(box); }
  void addInstance(std::uint32_t id) { instances_.push_back(id); }

  // Appends boxes of what was hidden, at most so many. Where there are more they are spread over all of them,
  // others in each turn. Instances that have gone since, or that have no box now, are left out, also where
  // another one has got the id, and so are those for which is_drawn(id) is false.
  template <typename IsDrawn>
  void append(const WorldData& data, std::size_t most, std::size_t turn, const IsDrawn& is_drawn,
              std::vector<Box>& boxes) const {
    const Vec3d moved = origin_ - data.origin;
    culling::spreadOver(nodes_.size() + instances_.size(), most, turn, [&](std::size_t i) {
      if (i < nodes_.size()) {
        boxes.push_back({Vec3f(Vec3d(nodes_[i].min) + moved), Vec3f(Vec3d(nodes_[i].max) + moved)});
      } else if (const std::uint32_t id = instances_[i - nodes_.size()]; isThere(data, id) && is_drawn(id)) {
        boxes.push_back(data.boxOf(id));
      }
    });
  }

 private:
  bool isThere(const WorldData& data, std::uint32_t id) const {
    return id < data.instances.size() && data.hasBox(id) && data.instances[id].born <= version_;
  }

  std::vector<Box> nodes_;  // relative to origin_
  std::vector<std::uint32_t> instances_;
  Vec3d origin_;               // of the world's boxes in that view
  std::uint64_t version_ = 0;  // of the world
};

}  // namespace sightline::world
