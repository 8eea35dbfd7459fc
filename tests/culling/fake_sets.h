#pragma once

// Potentially visible sets that a test chooses itself, without a bake.

#include <limits>
#include <random>
#include <vector>

#include "sightline/hierarchy/box_tree.h"
#include "sightline/occlusion/visible_sets.h"

namespace sightline::fake_sets {

class FakeSets final : public VisibleSets {
 public:
  explicit FakeSets(std::span<const Box> bounds) : tree_(buildBoxTree(bounds, {})) {}

  // Sets what find() returns from now on. members: by object, true if it is in the set.
  void use(std::uint32_t id, const std::vector<bool>& members) {
    id_ = id;
    nodes_.clear();
    const BoxTreeView tree = tree_.view();
    for (std::uint32_t n = 0; n < tree.nodes.size();) {
      bool all = true;
      for (const ObjectId object : tree.objectsBelow(n)) {
        all = all && members[object.value];
      }
      if (all) {
        nodes_.push_back(n);
      }
      n = all ? tree.nodes[n].end : n + 1;
    }
  }
  void useEverything() {
    id_ = VisibleSet::kEverything;
    nodes_ = {0};
  }

  BoxTreeView boxes() const override { return tree_.view(); }
  VisibleSet find(const Vec3d& eye, double near_distance) override {
    ++finds;
    last_eye = eye;
    last_near_distance = near_distance;
    return {id_, nodes_};
  }
  std::size_t nodeCount() const { return nodes_.size(); }

  // Of find().
  std::size_t finds = 0;
  Vec3d last_eye;
  double last_near_distance = std::numeric_limits<double>::quiet_NaN();

 private:
  BoxTree tree_;
  std::uint32_t id_ = VisibleSet::kEverything;
  std::vector<std::uint32_t> nodes_{0};
};

// Returns a random set: some of the objects, none, all, or those in a part of the tree.
inline std::vector<bool> randomMembers(const BoxTreeView& tree, std::mt19937_64& random) {
  std::vector<bool> members(tree.objects.size(), random() % 8 == 0);
  switch (random() % 4) {
    case 0:
      for (std::size_t i = 0; i < members.size(); ++i) {
        members[i] = random() % 3 == 0;
      }
      break;
    case 1:
      for (int i = 0; i < 30; ++i) {
        const auto node = static_cast<std::uint32_t>(random() % tree.nodes.size());
        for (const ObjectId object : tree.objectsBelow(node)) {
          members[object.value] = i % 3 != 2;
        }
      }
      break;
    case 2:
      members[random() % members.size()].flip();
      break;
    default:
      break;
  }
  return members;
}

}  // namespace sightline::fake_sets
