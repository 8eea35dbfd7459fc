// Building the occlusion tree: Bittner, Havran, Slavik, CGI 1998, sections 5 and 6.1; the shadow volume BSP
// tree of Chin and Feiner, SIGGRAPH 1990.

#include "src/occlusion/tree/tree_build.h"

#include <algorithm>

namespace sightline::occlusion {

// Adds the frustum's side planes at the top: no shadow is stored outside them, and parts of boxes there do
// not count.
void TreeBuilder::addFrustum(const View& view) {
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

// True if the shadow of a piece comes closer to an edge that the piece lacks than slack and rounding allow.
// The plane of an open edge is inset by 32 slack and, for rounding, by 64 times kOnPlane; a quarter of the
// latter is enough for a piece that another plane has cut. The plane of a shared edge has a width instead.
// Beyond an edge of the piece, its shadow reaches as far as the plane there is wide.
bool TreeBuilder::comesNear(Piece piece, const Corner& edge) const {
  const VolumeBuilder& volumes = tree_->volumes;
  const auto distanceTo = [&](const Corner& e, const Vec3d& p) {
    return volumes.planes[e.edge.plane()].evaluate(p) * (e.edge.flipped() ? -1.0 : 1.0);
  };
  const auto width = [&](const Corner& e, const Vec3d& p) {
    return volumes.tolerances[e.edge.plane()] * (volumes.eye.orthographic ? 1.0 : l1Norm(p));
  };
  constexpr double kRoom = 48.0;
  const auto isNear = [&](const Vec3d& p) {
    const double room = kRoom * kOnPlane * (l1Norm(p) + tree_->on_plane_scale);
    const double tolerance = width(edge, p);
    return distanceTo(edge, p) > (tolerance > 0.0 ? -tolerance : room);
  };
  const std::span<const Corner> corners = stack_.of(piece);
  const std::size_t n = corners.size();
  // Whether an end of edge `of`, moved with the edge along the line to the other neighbour of that end, is
  // near.
  const auto isNearBeyond = [&](const Corner& of, const Vec3d& end, const Vec3d& neighbour) {
    const double by = width(of, end), inside = -distanceTo(of, neighbour);
    return by > 0.0 && (!(inside > 0.0) || isNear(end + (end - neighbour) * (by / inside)));
  };
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3d &before = corners[(i + n - 1) % n].position, &from = corners[i].position,
                &to = corners[(i + 1) % n].position, &after = corners[(i + 2) % n].position;
    if (isNear(from) || isNearBeyond(corners[i], from, before) || isNearBeyond(corners[i], to, after)) {
      return true;
    }
  }
  return false;
}

// Makes the subtree for one lit piece of a fragment: a node for each edge, with shadow behind all of them.
Link TreeBuilder::occlusionVolume(Piece piece, const Fragment& fragment, std::uint32_t depth) {
  TreeData& tree = *tree_;
  edges_.clear();
  for (const Corner& corner : stack_.of(piece)) {
    if (!corner.embedded || !limits_.modified) {
      edges_.push_back(corner);
    }
  }
  // A cut may have taken an edge from the piece and left parts of it near to the edge, or wholly before its
  // plane.
  for (const Corner& edge : stack_.of(fragment.outline)) {
    const auto corners = stack_.of(piece);
    const auto own = std::find_if(corners.begin(), corners.end(),
                                  [&](const Corner& corner) { return corner.edge.samePlane(edge.edge); });
    if (own != corners.end() && own->edge.flipped() != edge.edge.flipped()) {
      return Link::out();
    }
    if (own == corners.end() && comesNear(piece, edge)) {
      edges_.push_back(edge);
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
    // What comes to an embedded edge has passed a plane that is as wide, or nearly: all of it counts as
    // behind.
    const double tolerance =
        tree.volumes.tolerances[edge.edge.plane()] + (edge.embedded ? 2.0 * stack_.equal_tolerance : 0.0);
    tree.nodes.push_back({plane, tolerance, edge.embedded, Link::out(), link});
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

// Sets the outline of a fragment of a polygon: its own edges, and those of the polygon that it lacks, unless
// it has another part of the same edge. Where an edge is shared in part, the cut itself keeps the shared part
// away from the open one, whose plane would open the seam.
void TreeBuilder::addOutline(Fragment& fragment, Piece whole, std::span<const EdgeCut> cuts) {
  const auto has = [&](Piece piece, PlaneRef edge) {
    const auto corners = stack_.of(piece);
    return std::any_of(corners.begin(), corners.end(),
                       [&](const Corner& corner) { return corner.edge.bits == edge.bits; });
  };
  const auto isOtherPart = [&](PlaneRef edge) {
    return std::any_of(cuts.begin(), cuts.end(), [&](const EdgeCut& cut) {
      return (edge.bits == cut.inset.bits && has(fragment.piece, cut.on_line)) ||
             (edge.bits == cut.on_line.bits && has(fragment.piece, cut.inset));
    });
  };
  Piece& outline = fragment.outline;
  outline = {static_cast<std::uint32_t>(stack_.corners.size()), 0};
  const auto add = [&](Corner corner) {
    stack_.corners.push_back(corner);
    ++outline.count;
  };
  for (std::uint32_t i = 0; i < fragment.piece.count; ++i) {
    add(stack_.corners[fragment.piece.first + i]);
  }
  for (std::uint32_t i = 0; i < whole.count; ++i) {
    const PlaneRef edge = stack_.corners[whole.first + i].edge;
    if (!has(outline, edge) && !isOtherPart(edge)) {
      add(stack_.corners[whole.first + i]);
    }
  }
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
    const std::size_t first_fragment = fragments_.size(), first_cut = next_cut;
    fragments_.push_back({piece, v, piece});
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
    if (next_cut > first_cut) {
      for (std::size_t f = first_fragment; f < fragments_.size(); ++f) {
        addOutline(fragments_[f], piece, std::span(volumes.cuts).subspan(first_cut, next_cut - first_cut));
      }
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
  stack_.tolerances = &tree.volumes.tolerances;
  stack_.equal_tolerance = 8.0 * kOnPlane * (view.orthographic ? tree.volumes.reach : 1.0);
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
