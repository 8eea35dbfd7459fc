#pragma once

// The parts of a sorter that are divided, as trees of planes, and the pieces that stand for them.

#include <cstdint>
#include <utility>
#include <vector>

#include "sightline/layers/cycle_splitter.h"
#include "sightline/layers/layer_sorter.h"
#include "src/layers/split/part_shape.h"

namespace sightline::layers {

class PieceTrees {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  struct Node {
    PartId part{};                 // its number in the sorter; a divided piece has none
    PartId whole{};                // the part that the tree is of
    std::uint64_t generation = 0;  // of a root: LayerSorter::generationOf() its part
    std::uint32_t parent = kNone, front = kNone, behind = kNone;
    Plane plane;          // of a divided node
    PartShape shape;      // with its hulls, unless this is a root
    double weight = 1.0;  // share of the whole part
    std::uint32_t depth = 0;
    std::vector<HullId> hulls;  // of a piece, in the sorter
    bool in_use = true;
    // At the last look: whether the order could do without the division, or both halves are in one group, so
    // that it is in vain, and since which frame.
    bool is_superfluous = false, is_in_vain = false;
    std::uint64_t superfluous_since = 0;

    bool isDivided() const { return front != kNone; }
  };

  explicit PieceTrees(LayerSorter& sorter) : sorter_(&sorter) {}

  // The node of a part or piece of the sorter; kNone for a part that is not divided.
  std::uint32_t find(PartId part) const;
  // The root of a part's tree, made if there is none.
  std::uint32_t rootOf(PartId part);
  Node& operator[](std::uint32_t node) { return nodes_[node]; }
  const Node& operator[](std::uint32_t node) const { return nodes_[node]; }
  std::uint32_t size() const { return static_cast<std::uint32_t>(nodes_.size()); }

  // Divides a part or piece: it leaves the order, and two parts take its place. The node in front is the
  // first of the two that are returned.
  std::pair<std::uint32_t, std::uint32_t> divide(std::uint32_t node, const Plane& plane, PartShape front,
                                                 PartShape behind, double weight_in_front);
  // Joins two pieces that are not divided again.
  void join(std::uint32_t node);
  bool canJoin(std::uint32_t node) const;
  // Joins all pieces of a part, which takes its tree away and enables it.
  void joinAll(PartId whole);

  // Moves all pieces to where their parts are.
  void place();
  void collect(std::vector<PartPiece>& pieces) const;  // ascending by piece
  std::uint32_t pieces() const { return pieces_; }
  std::uint32_t dividedParts() const;

 private:
  std::uint32_t makeNode();
  void release(std::uint32_t node);
  void addToSorter(std::uint32_t node, PartId like);
  void removeFromSorter(std::uint32_t node);
  void setNode(PartId part, std::uint32_t node);

  LayerSorter* sorter_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> free_nodes_;
  std::vector<std::uint32_t> node_of_;  // by the sorter's numbers
  std::vector<HullId> free_hulls_;
  std::uint32_t pieces_ = 0;
};

}  // namespace sightline::layers
