#pragma once

// What may hide single objects from somewhere in a cell: lists of occluders, made once for a cell, for the
// questions about all cells within it and about the sides of their planes.
//
// Whatever hides an object from a region within the cell meets each line from there to the corners of the
// object's box. Such a line lies in the hull of the cell and the corner.

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "src/pvs/bake/bake_scene.h"
#include "src/pvs/bake/object_mask.h"

namespace sightline::pvs {

// Some boxes side by side, with the numbers of their occluders.
struct LanesRange {
  const BoxLanes* boxes = nullptr;
  std::size_t first = 0, count = 0;
};

// Use by one thread at a time.
class CellCandidates {
 public:
  // scene must outlive this.
  explicit CellCandidates(const BakeScene& scene) : scene_(&scene) {}

  // Makes the lists anew, for a cell from which none of the hidden objects is seen. around: the lists of a
  // cell that holds this one, for no more hidden objects; none if null. False if the lists would have more
  // than `most` occluders in all, and then they are of no use.
  bool make(const CellBox& cell, const ObjectMask& hidden, const CellCandidates* around, std::size_t most);

  // Leaves of the shadow tree that lie side by side, at most ShadowTree::kGroup.
  struct Group {
    std::uint32_t first = 0;         // the first node
    std::uint32_t leaves = 0;        // bits of those that are not hidden but may be
    std::size_t begin = 0, end = 0;  // their occluders, in the lists
  };
  // All objects that may be hidden from some region within the cell, but those that are hidden from all of
  // it.
  std::span<const Group> groups() const { return groups_; }
  // The occluders of a group: whatever is of use to the smallest cells and may hide one of the leaves from a
  // region within the cell, without those of hidden objects.
  LanesRange occludersOf(const Group& group) const { return {&lists_, group.begin, group.end - group.begin}; }
  std::size_t size() const { return lists_.size(); }

 private:
  struct Visit {
    CellBox cell{};
    const ObjectMask* hidden = nullptr;
    std::size_t most = 0;
  };
  bool narrow(const Visit& visit, const CellCandidates& around);
  // Adds the groups of a node's children and of all below. above: what may hide something below the node; all
  // if its boxes are null.
  bool search(const Visit& visit, std::uint32_t node, LanesRange above, std::size_t depth);
  bool searchGroup(const Visit& visit, std::uint32_t first, std::uint32_t count, LanesRange above,
                   std::size_t depth);
  // Bits of the leaves, out of `some`, that are not hidden but may be.
  std::uint32_t leavesOf(const Visit& visit, std::uint32_t first, std::uint32_t some) const;
  bool addGroup(const Visit& visit, std::uint32_t first, std::uint32_t leaves, LanesRange above);
  // Sets places_ to those of `above` that meet the hulls of the cell and each of the bounds of corners, and
  // the boxes that the places are of to the result. corners_of(i): bounds of corner i of the boxes.
  template <typename CornersOf>
  bool findPlaces(const Visit& visit, const CornersOf& corners_of, LanesRange above, std::size_t most,
                  const BoxLanes*& boxes);

  const BakeScene* scene_;
  std::vector<Group> groups_;
  BoxLanes lists_;
  // Scratch.
  std::vector<std::uint32_t> places_;
  std::deque<BoxLanes> above_;  // by depth of the node below which they are searched
};

}  // namespace sightline::pvs
