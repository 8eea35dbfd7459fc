#pragma once

// What a baked file claims, one by one: an object is hidden from a cell, or from a side of its plane. And
// what is recorded of each claim.

#include <algorithm>
#include <cstdint>
#include <functional>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/pvs/format/witness.h"
#include "sightline/pvs/query/sight_file.h"
#include "tools/sightline/cull/hidden_pairs.h"

namespace sightline::tool {

// A witness and a place in BoxTree::objects that it hides.
struct WitnessUse {
  std::uint32_t witness = 0, position = 0;
  friend bool operator==(const WitnessUse&, const WitnessUse&) = default;
  friend auto operator<=>(const WitnessUse&, const WitnessUse&) = default;
};

class WitnessIndex {
 public:
  // The witnesses must outlive this.
  explicit WitnessIndex(const std::vector<HidingWitness>& witnesses);

  // True if no eye is in the claim's part of a cell, given by its number.
  using IsEmpty = std::function<bool(std::uint64_t)>;

  // Appends the witnesses that together show that an object is hidden from a part of a cell: one of this
  // cell, or of one around it, or one for each of the eight cells below it, but for those without eyes. False
  // if there are none.
  bool find(std::uint64_t cell, CellPart part, std::uint32_t position, const IsEmpty& is_empty,
            std::vector<WitnessUse>& uses) const;

 private:
  bool findOwn(std::uint64_t cell, CellPart part, std::uint32_t position,
               std::vector<WitnessUse>& uses) const;
  bool findBelow(std::uint64_t cell, CellPart part, std::uint32_t position, const IsEmpty& is_empty,
                 std::vector<WitnessUse>& uses) const;

  const std::vector<HidingWitness>& witnesses_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> by_cell_;
  std::unordered_set<std::uint64_t> has_below_;  // cells around cells that have witnesses
};

// Calls visit(leaf, cell, part, positions of the hidden objects in BoxTree::objects) for all parts of all
// leaves. Error if a set is corrupt.
template <typename Visit>
Status forEachHidden(const SightFile& baked, Visit&& visit) {
  const OctreeView octree = baked.octree();
  const BoxTreeView boxes = baked.boxes();
  Status status = Success{};
  std::vector<std::uint32_t> nodes, hidden;
  std::vector<std::uint8_t> visible;
  forEachLeaf(octree, [&](std::uint32_t leaf, const OctreeCell& cell) {
    const OctreeLeaf& record = octree.leaves[leaf];
    const bool divided = record.plane != OctreeLeaf::kNoPlane;
    const auto visitPart = [&](CellPart part, std::uint32_t set) {
      nodes.clear();
      if (const Status ok = baked.readSet(set, nodes); !ok) {
        status = ok;
        return;
      }
      visible.assign(boxes.objects.size(), 0);
      for (const std::uint32_t node : nodes) {
        const BoxNode& n = boxes.nodes[node];
        std::fill_n(visible.begin() + n.first_object, n.object_count, std::uint8_t{1});
      }
      hidden.clear();
      for (std::uint32_t p = 0; p < visible.size(); ++p) {
        if (visible[p] == 0) {
          hidden.push_back(p);
        }
      }
      visit(leaf, cell, part, hidden);
    };
    visitPart(divided ? CellPart::kBetween : CellPart::kWhole, record.set);
    if (divided) {
      visitPart(CellPart::kFront, record.front_set);
      visitPart(CellPart::kBack, record.back_set);
    }
  });
  return status;
}

}  // namespace sightline::tool
