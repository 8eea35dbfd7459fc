#pragma once

#include "occlusion/front_to_back.h"
#include "occlusion/tree_data.h"

namespace sightline::occlusion_detail {

struct TreeLimits {
  bool modified = true;  // MOBSP: edges embedded in planes above add no node
  bool clip_to_frustum = true;
  std::uint32_t max_nodes = 1 << 16;
};

// Builds the tree; storage is reused from one build to the next.
class TreeBuilder {
 public:
  // False when the limits did not suffice: the tree is then not usable.
  bool build(const View& view, std::span<const ChosenOccluders> sets, const TreeLimits& limits,
             TreeData& tree);

 private:
  static constexpr std::uint32_t kMaxDepth =
      1500;  // the recursion of queries stays within any thread's stack

  void addFrustum(const View& view);
  void makeFragments();
  void filterDown(Link& link, Piece piece, std::uint32_t volume, std::uint32_t depth);
  void filterDownNode(std::size_t node, Piece piece, std::uint32_t volume, std::uint32_t depth);
  Link occlusionVolume(Piece piece, std::uint32_t volume, std::uint32_t depth);

  TreeData* tree_ = nullptr;
  TreeLimits limits_;
  bool failed_ = false;
  PolygonStack stack_;
  FrontToBack front_to_back_;
  std::vector<Fragment> fragments_;
};

}  // namespace sightline::occlusion_detail
