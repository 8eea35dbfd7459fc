// Asking the occlusion tree: Bittner, Havran, Slavik, CGI 1998, sections 5.1, 5.2 and 6.2.
// Differs from the paper in: a box that crosses the plane of a leaf's occluder without meeting the occluder
// is called hidden there only if it also stays out of the pyramid between the eye and the occluder. The
// paper's test of the intersection alone takes a box that is in front of the occluder, and crosses its plane
// beside it, for a hidden one.

#include "occlusion/tree_classify.h"

#include <algorithm>
#include <array>

namespace sightline::occlusion_detail {
namespace {

double supportMargin(const OcclusionVolume& volume, const Vec3d& p) {
  return volume.depth_slack + kDepthMargin * magnitude(p);
}

// The four corners of the face of the box on one side of an axis.
std::array<Vec3d, 4> faceOf(const EyeBox& box, int axis, bool high) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  std::array<Vec3d, 4> corners;
  for (std::size_t i = 0; i < 4; ++i) {
    Vec3d& p = corners[i];
    p[axis] = high ? box.max[axis] : box.min[axis];
    p[u] = (i == 1 || i == 2) ? box.max[u] : box.min[u];
    p[v] = i >= 2 ? box.max[v] : box.min[v];
  }
  return corners;
}

// The sides of an axis on which the box has a face towards the eye: -1, 0 (none), 1.
int facingSide(const EyeBox& box, const Eye& eye, int axis) {
  if (eye.orthographic) {
    return eye.forward[axis] > 0.0 ? -1 : eye.forward[axis] < 0.0 ? 1 : 0;
  }
  return box.min[axis] > 0.0 ? -1 : box.max[axis] < 0.0 ? 1 : 0;
}

}  // namespace

State boxBehindSupport(const OcclusionVolume& volume, const EyeBox& box) {
  const Vec3d center = box.center(), half = box.half();
  const double distance = volume.support.evaluate(center);
  const double radius = dot(abs(volume.support.normal), half);
  const double margin = supportMargin(volume, abs(center) + half);
  if (distance + radius < -margin) {
    return State::kHidden;
  }
  return distance - radius > -margin ? State::kVisible : State::kPartial;
}

State SplittingQuery::leaf(const ShadowLeaf& leaf, Piece piece) const {
  const OcclusionVolume& volume = tree_->volumes.volumes[leaf.volume];
  if (!exact_) {
    return boxBehindSupport(volume, *box_);
  }
  for (const Corner& corner : stack_.of(piece)) {
    if (!(volume.support.evaluate(corner.position) < -supportMargin(volume, corner.position))) {
      // A part of the face is seen. Whether all of the box is depends on what of it lies behind the occluder.
      return boxBehindSupport(volume, *box_) == State::kVisible ? State::kVisible : State::kPartial;
    }
  }
  return State::kHidden;
}

// The part of the piece in front of a plane, or behind it; empty when there is none.
Piece SplittingQuery::part(const SplitResult& split, Piece whole, bool front) {
  switch (split.side) {
    case Side::kFront:
      return front ? whole : Piece{};
    case Side::kBack:
      return front ? Piece{} : whole;
    case Side::kBoth:
      return front ? split.front : split.back;
    default:
      return whole;
  }
}

State SplittingQuery::bothSides(const TreeNode& node, Piece front, Piece back) {
  State state = front.count != 0 ? polygon(node.front, front) : State::kNothing;
  if (state != State::kPartial && back.count != 0) {
    state = combine(state, polygon(node.back, back));
  }
  return stack_.overflow ? State::kPartial : state;
}

State SplittingQuery::node(const TreeNode& node, Piece piece) {
  const std::size_t stack_size = stack_.corners.size();
  const auto splitBy = [&](double shift) {
    const Plane plane{node.plane.normal, node.plane.offset + shift};
    return stack_.split(piece, plane, PlaneRef{}, on_plane_scale_, 0.0);
  };
  State state = State::kNothing;
  if (node.tolerance == 0.0) {
    const SplitResult split = splitBy(0.0);
    state = bothSides(node, part(split, piece, true), part(split, piece, false));
  } else {
    // The parts that the two sides of a seam get overlap.
    const double width = overlapWidth(node.tolerance, reach_, tree_->volumes.eye, tree_->on_plane_scale);
    const Piece front = part(splitBy(node.repeated ? -width : width), piece, true);
    state = bothSides(node, front, part(splitBy(-width), piece, false));
  }
  stack_.corners.resize(stack_size);
  return state;
}

State SplittingQuery::polygon(Link link, Piece piece) {
  if (link.isNode()) {
    return node(tree_->nodes[link.nodeIndex()], piece);
  }
  if (link.isOut()) {
    return State::kVisible;
  }
  return link.isOutside() ? State::kNothing : leaf(tree_->leaves[link.leafIndex()], piece);
}

State SplittingQuery::classify(const TreeData& tree, const EyeBox& box, bool exact) {
  tree_ = &tree;
  box_ = &box;
  exact_ = exact;
  reach_ = magnitude(max(abs(box.min), abs(box.max)));
  // Of the box's nearest point: a corner far away may be the end of an edge that passes close by.
  on_plane_scale_ = magnitude(max(max(box.min, -box.max), Vec3d())) + tree.on_plane_scale;
  stack_.overflow = false;
  State state = State::kNothing;
  for (int axis = 0; axis < 3 && state != State::kPartial; ++axis) {
    const int side = facingSide(box, tree.volumes.eye, axis);
    if (side == 0) {
      continue;
    }
    stack_.corners.clear();
    for (const Vec3d& p : faceOf(box, axis, side > 0)) {
      stack_.corners.push_back({p, PlaneRef{}, false});
    }
    state = combine(state, polygon(tree.root, {0, 4}));
  }
  return state;
}

namespace {

class PlaneQuery {
 public:
  PlaneQuery(const TreeData& tree, const EyeBox& box, bool exact)
      : tree_(tree), box_(box), exact_(exact), center_(box.center()), half_(box.half()) {
    reach_ = magnitude(center_) + magnitude(half_);
  }

  State ask(Link link) const {
    if (link.isOut()) {
      return State::kVisible;
    }
    if (link.isOutside()) {
      return State::kNothing;
    }
    if (!link.isNode()) {
      return leaf(tree_.leaves[link.leafIndex()]);
    }
    const TreeNode& node = tree_.nodes[link.nodeIndex()];
    const double distance = node.plane.evaluate(center_);
    const double radius = dot(abs(node.plane.normal), half_);
    const double width = overlapWidth(node.tolerance, reach_, tree_.volumes.eye, tree_.on_plane_scale);
    if (distance - radius >= width) {
      return ask(node.front);
    }
    if (distance + radius <= (node.repeated ? width : -width)) {
      return ask(node.back);
    }
    const State front = ask(node.front);
    return front == State::kPartial ? front : combine(front, ask(node.back));
  }

 private:
  State leaf(const ShadowLeaf& leaf) const {
    const State state = boxBehindSupport(tree_.volumes.volumes[leaf.volume], box_);
    if (exact_ && state == State::kPartial && disjointFromPyramid(tree_, leaf, box_)) {
      return State::kHidden;
    }
    return state;
  }

  const TreeData& tree_;
  const EyeBox& box_;
  bool exact_;
  Vec3d center_, half_;
  double reach_;
};

// Separating-axis test of the box against a set of points. Grows the box by the margin.
class SeparatingAxis {
 public:
  SeparatingAxis(std::span<const Vec3d> base, bool orthographic, const Vec3d& forward, const EyeBox& box,
                 double margin)
      : base_(base),
        orthographic_(orthographic),
        forward_(forward),
        center_(box.center()),
        half_(box.half()),
        margin_(margin) {}

  // axis: any length.
  bool separates(const Vec3d& axis) const {
    const double c = dot(axis, center_);
    const double r = dot(abs(axis), half_);
    double low = 0.0, high = 0.0;  // of the pyramid; its apex is the eye at 0
    const double along = dot(axis, forward_);
    for (std::size_t i = 0; i < base_.size(); ++i) {
      const double d = dot(axis, base_[i]);
      // Orthographic: from the base back to the camera's plane.
      const double other = orthographic_ ? d - along * dot(forward_, base_[i]) : d;
      if (i == 0 && orthographic_) {
        low = high = d;
      }
      low = std::min({low, d, other});
      high = std::max({high, d, other});
    }
    const double margin = margin_ * length(axis);
    return c - r > high + margin || c + r < low - margin;
  }

 private:
  std::span<const Vec3d> base_;
  bool orthographic_;
  Vec3d forward_, center_, half_;
  double margin_;
};

}  // namespace

bool disjointFromPyramid(const TreeData& tree, const ShadowLeaf& leaf, const EyeBox& box) {
  const OcclusionVolume& volume = tree.volumes.volumes[leaf.volume];
  const Eye& eye = tree.volumes.eye;
  const auto base = std::span(tree.corners).subspan(leaf.first_corner, leaf.corner_count);
  const double margin = supportMargin(volume, max(abs(box.min), abs(box.max))) + kDepthMargin * volume.reach;
  const SeparatingAxis test(base, eye.orthographic, eye.forward, box, margin);
  const std::array<Vec3d, 3> axes{Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)};
  for (const Vec3d& axis : axes) {
    if (test.separates(axis)) {
      return true;
    }
  }
  // The pyramid's side planes were on the way to the leaf, its base is what the box crosses: edges are left.
  for (std::size_t i = 0; i < base.size(); ++i) {
    const Vec3d along = base[(i + 1) % base.size()] - base[i];
    const Vec3d up = eye.orthographic ? eye.forward : base[i];
    for (const Vec3d& axis : axes) {
      if (test.separates(cross(axis, along)) || test.separates(cross(axis, up))) {
        return true;
      }
    }
    if (test.separates(cross(base[i], base[(i + 1) % base.size()]))) {
      return true;
    }
  }
  return false;
}

State classifyByPlanes(const TreeData& tree, const EyeBox& box, bool exact) {
  return PlaneQuery(tree, box, exact).ask(tree.root);
}

}  // namespace sightline::occlusion_detail
