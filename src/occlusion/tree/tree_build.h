#pragma once

#include "src/occlusion/tree/front_to_back.h"
#include "src/occlusion/tree/tree_data.h"

namespace sightline::occlusion {

struct TreeLimits {
  bool modified = true;  // edges embedded in planes above add no node (MOBSP in the paper)
  bool clip_to_frustum = true;
  std::uint32_t max_nodes = 1 << 16;
};

// Builds occlusion trees; storage is reused from one build to the next.
class TreeBuilder {
 public:
  // False: the limits did not suffice, and the tree cannot be used.
  bool build(const View& view, std::span<const ChosenOccluders> sets, const TreeLimits& limits,
             TreeData& tree);

 private:
  // Names a link of the tree: one of a node, or the root.
  struct Place {
    static constexpr std::uint32_t kRoot = 0xffffffffu;
    std::uint32_t node = kRoot;
    bool front = false;
  };
  // A piece on its way down the tree.
  struct Waiting {
    Place place;
    Piece piece;
    std::uint32_t depth = 0;         // number of nodes above the place
    std::size_t corners_needed = 0;  // the lowest so many corners of the stack are still in use
  };

  void addFrustum(const View& view);
  void makeFragments();
  void addOutline(Fragment& fragment, Piece whole, std::span<const EdgeCut> cuts);
  Link& at(Place place);
  void filterDown(const Fragment& fragment);
  void followToLeaf(Waiting piece, const Fragment& fragment);
  Link occlusionVolume(Piece piece, const Fragment& fragment, std::uint32_t depth);
  bool comesNear(Piece piece, const Corner& edge) const;

  TreeData* tree_ = nullptr;
  TreeLimits limits_;
  bool failed_ = false;
  PolygonStack stack_;
  std::vector<Waiting> waiting_;
  std::vector<Corner> edges_;  // that get a node for the current piece
  FrontToBack front_to_back_;
  std::vector<Fragment> fragments_;
};

}  // namespace sightline::occlusion
