// Building the occlusion tree: Bittner, Havran, Slavik, CGI 1998, sections 5 and 6.1; the shadow volume BSP
// tree of Chin and Feiner, SIGGRAPH 1990.

#include "src/occlusion/tree/tree_build.h"

#include <algorithm>

namespace sightline::occlusion {

// Adds the frustum's side planes at the top: no shadow is stored outside them, and parts of boxes there do
// not count.
void TreeBuilder::addFrustum(const View& view) {
  constexpr double kTouching = 0x1p-60;  // no more than rounding, so that what touches the frustum is in it
  const Frustum frustum = frustumOf(view);
  for (std::size_t i = 0; i < 4; ++i) {
    Plane outwards = frustum.planes[i].flipped();
    outwards.offset = view.orthographic ? outwards.evaluate(view.eye) : 0.0;
    TreeNode node{outwards, kTouching, false, Link::outside(), Link::node(i + 1)};
    if (i == 3) {
      node.back = Link::out();
    }
    tree_->nodes.push_back(node);
    tree_->node_plane.push_back(tree_->volumes.addPlane(outwards, kTouching));
  }
  tree_->root = Link::node(0);
  tree_->frustum_nodes = 4;
}

// True if the piece lacks this open edge and comes closer to it than slack and rounding allow. The edge's
// plane is inset by 32 slack and, for rounding, by 64 times kOnPlane; a quarter of the latter is enough for a
// piece that another plane has cut.
bool TreeBuilder::reachesBefore(Piece piece, const Corner& open_edge) const {
  const Plane& stored = tree_->volumes.planes[open_edge.edge.plane()];
  constexpr double kRoom = 48.0;
  bool in_front = false;
  for (const Corner& corner : stack_.of(piece)) {
    if (corner.edge.samePlane(open_edge.edge)) {
      return false;
    }
    const double distance = stored.evaluate(corner.position) * (open_edge.edge.flipped() ? -1.0 : 1.0);
    in_front = in_front || distance > kRoom * kOnPlane * (l1Norm(corner.position) + tree_->on_plane_scale);
  }
  return in_front;
}

// Makes the subtree for one lit piece of a fragment: a node for each edge, with shadow behind all of them.
Link TreeBuilder::occlusionVolume(Piece piece, const Fragment& fragment, std::uint32_t depth) {
  TreeData& tree = *tree_;
  // A cut may have taken an open edge from the piece and left parts of it closer to the edge than its inset.
  edges_.clear();
  for (const Corner& corner : stack_.of(piece)) {
    if (!corner.embedded || !limits_.modified) {
      edges_.push_back(corner);
    }
  }
  for (const Corner& corner : stack_.of(fragment.outline)) {
    if (corner.open && reachesBefore(piece, corner)) {
      edges_.push_back(corner);
      edges_.back().embedded = false;
    }
  }
  if (tree.nodes.size() + edges_.size() > limits_.max_nodes || depth + edges_.size() > kMaxTreeDepth) {
    failed_ = true;
    return Link::out();
  }
  ShadowLeaf leaf{fragment.volume, static_cast<std::uint32_t>(tree.corners.size()), piece.count};
  for (const Corner& corner : stack_.of(piece)) {
    tree.corners.push_back(corner.position);
  }
  tree.leaves.push_back(leaf);
  Link link = Link::shadow(tree.leaves.size() - 1);
  for (const Corner& edge : edges_) {
    const Plane& stored = tree.volumes.planes[edge.edge.plane()];
    const Plane plane = edge.edge.flipped() ? stored.flipped() : stored;
    tree.nodes.push_back(
        {plane, tree.volumes.tolerances[edge.edge.plane()], edge.embedded, Link::out(), link});
    tree.node_plane.push_back(edge.edge);
    link = Link::node(tree.nodes.size() - 1);
  }
  tree.depth = std::max(tree.depth, depth + static_cast<std::uint32_t>(edges_.size()));
  return link;
}

Link& TreeBuilder::at(Place place) {
  if (place.node == Place::kRoot) {
    return tree_->root;
  }
  TreeNode& node = tree_->nodes[place.node];
  return place.front ? node.front : node.back;
}

// Follows a piece to a leaf. Where the piece is split, the part behind is put on the stack.
void TreeBuilder::followToLeaf(Waiting moving, const Fragment& fragment) {
  while (at(moving.place).isNode()) {
    const auto index = static_cast<std::uint32_t>(at(moving.place).nodeIndex());
    const SplitResult split = stack_.split(moving.piece, tree_->nodes[index].plane, tree_->node_plane[index],
                                           tree_->on_plane_scale);
    ++moving.depth;
    switch (split.side) {
      case Side::kFront:
        moving.place = {index, true};
        break;
      case Side::kBack:
        moving.place = {index, false};
        break;
      case Side::kBoth:
        waiting_.push_back({{index, false}, split.back, moving.depth, stack_.corners.size()});
        moving.place = {index, true};
        moving.piece = split.front;
        break;
      case Side::kOnPlane:
        return;  // thinner than rounding: it hides nothing
    }
  }
  if (at(moving.place).isOut()) {
    // occlusionVolume() appends nodes, which may move the node of the link: keep no references across it.
    const Link made = occlusionVolume(moving.piece, fragment, moving.depth);
    at(moving.place) = made;
  }
}

void TreeBuilder::filterDown(const Fragment& fragment) {
  const std::size_t stack_size = stack_.corners.size();
  waiting_.clear();
  waiting_.push_back({Place{}, fragment.piece, 0, stack_size});
  while (!waiting_.empty() && !failed_) {
    const Waiting next = waiting_.back();
    waiting_.pop_back();
    stack_.corners.resize(next.corners_needed);
    followToLeaf(next, fragment);
  }
  stack_.corners.resize(stack_size);
}

// Makes one fragment for each volume, or several where parts of its edges are open.
void TreeBuilder::makeFragments() {
  VolumeBuilder& volumes = tree_->volumes;
  std::size_t next_cut = 0;
  for (std::uint32_t v = 0; v < volumes.volumes.size(); ++v) {
    const OcclusionVolume& volume = volumes.volumes[v];
    const Piece piece{static_cast<std::uint32_t>(stack_.corners.size()), volume.corner_count};
    const auto first = volumes.corners.begin() + volume.first_corner;
    stack_.corners.insert(stack_.corners.end(), first, first + volume.corner_count);
    const std::size_t first_fragment = fragments_.size();
    fragments_.push_back({piece, v, {}});
    for (; next_cut < volumes.cuts.size() && volumes.cuts[next_cut].volume == v; ++next_cut) {
      const Plane plane = volumes.cuts[next_cut].plane;
      const std::size_t before = fragments_.size();
      for (std::size_t f = first_fragment; f < before; ++f) {
        Fragment front, back;
        if (cutFragment(fragments_[f], plane, volumes, stack_, front, back)) {
          fragments_[f] = front;
          fragments_.push_back(back);
        }
      }
    }
    for (std::size_t f = first_fragment; f < fragments_.size(); ++f) {
      fragments_[f].outline = fragments_[f].piece;
    }
  }
}

bool TreeBuilder::build(const View& view, std::span<const ChosenOccluders> sets, const TreeLimits& limits,
                        TreeData& tree) {
  tree_ = &tree;
  limits_ = limits;
  failed_ = false;
  tree.root = Link::out();
  tree.nodes.clear();
  tree.node_plane.clear();
  tree.leaves.clear();
  tree.corners.clear();
  tree.depth = 0;
  tree.frustum_nodes = 0;
  tree.volumes.build(view, sets);
  tree.on_plane_scale = view.orthographic ? tree.volumes.reach : 0.0;
  if (limits.clip_to_frustum) {
    addFrustum(view);
  }
  stack_.overflow = false;
  stack_.planes = &tree.volumes.planes;
  stack_.corners.clear();
  fragments_.clear();
  makeFragments();
  front_to_back_.order(tree.volumes, stack_, fragments_);
  for (const Fragment& fragment : fragments_) {
    filterDown(fragment);
  }
  return !failed_ && !stack_.overflow;
}

}  // namespace sightline::occlusion
