// Classifying boxes by the occlusion tree: Bittner, Havran, Slavik, CGI 1998, sections 5.1, 5.2 and 6.2.
// Differs from the paper in: faces are not compared with planes of the frustum that the box is inside of. In
// the conservative test of a region (6.2) a leaf that would change the answer counts only if the box's image,
// split by the planes that the box crosses on the way there, reaches it. A box that crosses the plane of a
// leaf's occluder and is disjoint from the occluder is hidden there only if it is also disjoint from the
// pyramid between the eye and the occluder. The paper's test, of the intersection alone, takes a box that is
// in front of the occluder and crosses its plane beside it for hidden.

#include "src/occlusion/tree/tree_classify.h"

#include <algorithm>
#include <array>
#include <limits>

namespace sightline::occlusion {
namespace {

double supportMargin(const OcclusionVolume& volume, const Vec3d& p) {
  return volume.depth_slack + kDepthMargin * l1Norm(p);
}

// Returns the four corners of the face of the box on one side of an axis.
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

// Returns the side of an axis on which the box has a face towards the eye: -1, 1, or 0 for none.
int facingSide(const EyeBox& box, const Eye& eye, int axis) {
  if (eye.orthographic) {
    return eye.sight[axis] > 0.0 ? -1 : eye.sight[axis] < 0.0 ? 1 : 0;
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

State SplittingQuery::leaf(Link link, Piece piece) const {
  if (link.isOut()) {
    return State::kVisible;
  }
  if (link.isOutside()) {
    return State::kNothing;
  }
  const OcclusionVolume& volume = tree_->volumes.volumes[tree_->leaves[link.leafIndex()].volume];
  if (!question_->exact) {
    return boxBehindSupport(volume, question_->box);
  }
  for (const Corner& corner : stack_.of(piece)) {
    if (!(volume.support.evaluate(corner.position) < -supportMargin(volume, corner.position))) {
      // A part of the face is seen. Whether all of the box is depends on what of it lies behind the occluder.
      return boxBehindSupport(volume, question_->box) == State::kVisible ? State::kVisible : State::kPartial;
    }
  }
  return State::kHidden;
}

// Splits by the node's plane, moved against its normal by the shift (metres).
SplitResult SplittingQuery::split(const TreeNode& node, Piece piece, double shift) {
  const Plane plane{node.plane.normal, node.plane.offset + shift};
  const SplitResult result = stack_.split(piece, plane, PlaneRef{}, on_plane_scale_, 0.0);
  counts.cuts += result.side == Side::kBoth ? 1 : 0;
  return result;
}

SplittingQuery::Parts SplittingQuery::partsOf(const TreeNode& node, Piece piece) {
  ++counts.plane_tests;
  const auto partsIn = [&](const SplitResult& split) {
    switch (split.side) {
      case Side::kFront:
        return Parts{piece, {}};
      case Side::kBack:
        return Parts{{}, piece};
      case Side::kBoth:
        return Parts{split.front, split.back};
      default:
        return Parts{piece, piece};
    }
  };
  const Eye& eye = tree_->volumes.eye;
  if (node.tolerance == 0.0 && !overlapping_) {
    return partsIn(split(node, piece, 0.0));
  }
  const double width = overlapWidth(node.tolerance, reach_, eye, tree_->on_plane_scale);
  const double front_from = node.repeated ? width : -width;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Corner& corner : stack_.of(piece)) {
    const double distance = node.plane.evaluate(corner.position);
    low = std::min(low, distance);
    high = std::max(high, distance);
  }
  if (low >= width) {
    return {piece, {}};
  }
  if (high <= front_from) {
    return {{}, piece};
  }
  const Piece front = low >= front_from ? piece : partsIn(split(node, piece, -front_from)).front;
  return {front, high <= width ? piece : partsIn(split(node, piece, -width)).back};
}

State SplittingQuery::polygon(Link link, Piece piece) {
  State state = State::kNothing;
  waiting_.clear();
  waiting_.push_back({link, piece, stack_.corners.size()});
  while (!waiting_.empty() && state != State::kPartial) {
    Waiting moving = waiting_.back();
    waiting_.pop_back();
    stack_.corners.resize(moving.corners_needed);
    while (moving.link.isNode()) {
      const TreeNode& node = tree_->nodes[moving.link.nodeIndex()];
      const Parts parts = partsOf(node, moving.piece);
      if (stack_.overflow) {
        return State::kPartial;
      }
      const bool in_front = parts.front.count != 0;
      if (in_front && parts.back.count != 0) {
        waiting_.push_back({node.back, parts.back, stack_.corners.size()});
      }
      moving.link = in_front ? node.front : node.back;
      moving.piece = in_front ? parts.front : parts.back;
    }
    state = combine(state, leaf(moving.link, moving.piece));
  }
  return state;
}

// Classifies a face, of which only the part in the frustum counts.
State SplittingQuery::face(Piece piece) {
  for (std::size_t i = 0; i < tree_->frustum_nodes; ++i) {
    if (question_->mayCross(i)) {
      piece = partsOf(tree_->nodes[i], piece).back;
      if (piece.count == 0) {
        return State::kNothing;
      }
    }
  }
  return polygon(tree_->belowFrustum(), piece);
}

State SplittingQuery::classify(const TreeData& tree, const BoxQuestion& question) {
  tree_ = &tree;
  question_ = &question;
  const EyeBox& box = question.box;
  reach_ = box.farthest();
  // The scale is that of the box's nearest point: a corner far away may be the end of an edge that passes
  // close by.
  on_plane_scale_ = box.nearest() + tree.on_plane_scale;
  // As many times as far as the nearest point, rounding reaches a quarter of kEdgeMargin after some 100 cuts.
  constexpr double kFar = 16.0;
  overlapping_ = tree.volumes.eye.orthographic || reach_ > kFar * box.nearest();
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
    state = combine(state, face({0, 4}));
  }
  return state;
}

State PlaneQuery::leaf(Link link, State so_far) {
  if (link.isOutside()) {
    return State::kNothing;
  }
  const bool lit = link.isOut();
  State state =
      lit ? State::kVisible
          : boxBehindSupport(tree_->volumes.volumes[tree_->leaves[link.leafIndex()].volume], question_->box);
  // Cutting the image takes longer than testing planes. It is left out for a leaf that does not change the
  // answer, and for shadow as long as no other leaf was reached.
  if (combine(so_far, state) == so_far || (so_far == State::kNothing && state == State::kHidden)) {
    return state;
  }
  if (!imageReaches()) {
    return State::kNothing;
  }
  if (state == State::kPartial && question_->exact &&
      disjointFromPyramid(*tree_, tree_->leaves[link.leafIndex()], question_->box)) {
    return State::kHidden;
  }
  return state;
}

// Whether the box's image has a point on the path's side of all its planes. If not, everything that is still
// to be visited behind the planes that suffice to show this is dropped.
bool PlaneQuery::imageReaches() {
  if (path_.size() < 2 || path_.size() > BoxImage::kMaxCuts) {
    return true;  // one plane: the box crosses it
  }
  if (!has_image_) {
    image_.begin(question_->box, tree_->volumes.eye, tree_->on_plane_scale);
    has_image_ = true;
  }
  while (image_.cutCount() < path_.size()) {
    const Crossing crossing = path_[image_.cutCount()];
    ++counts.cuts;
    if (!image_.cut(tree_->nodes[crossing.node], crossing.front)) {
      while (!waiting_.empty() && waiting_.back().crossings > image_.cutCount()) {
        waiting_.pop_back();
      }
      return false;
    }
  }
  return true;
}

Side PlaneQuery::sideOf(const TreeNode& node) {
  ++counts.plane_tests;
  const double distance = node.plane.evaluate(center_);
  const double radius = dot(abs(node.plane.normal), half_);
  const double width = overlapWidth(node.tolerance, reach_, tree_->volumes.eye, tree_->on_plane_scale);
  return distance - radius >= width ? Side::kFront : distance + radius <= -width ? Side::kBack : Side::kBoth;
}

// Descends to a leaf. Where the box crosses a plane, the back side is put on the stack.
Link PlaneQuery::descend(Link link) {
  while (link.isNode()) {
    const TreeNode& node = tree_->nodes[link.nodeIndex()];
    const Side side = sideOf(node);
    if (side == Side::kBoth) {
      path_.push_back({static_cast<std::uint32_t>(link.nodeIndex()), true});
      waiting_.push_back({node.back, static_cast<std::uint32_t>(path_.size())});
    }
    link = side == Side::kBack ? node.back : node.front;
  }
  return link;
}

State PlaneQuery::traverse(Link link) {
  State state = leaf(descend(link), State::kNothing);
  while (state != State::kPartial && !waiting_.empty()) {
    const Waiting next = waiting_.back();
    waiting_.pop_back();
    path_.resize(next.crossings);
    path_.back().front = false;
    if (has_image_) {
      image_.keepCuts(next.crossings - 1);
    }
    state = combine(state, leaf(descend(next.link), state));
  }
  return state;
}

State PlaneQuery::classify(const TreeData& tree, const BoxQuestion& question) {
  tree_ = &tree;
  question_ = &question;
  center_ = question.box.center();
  half_ = question.box.half();
  reach_ = l1Norm(center_) + l1Norm(half_);
  has_image_ = false;
  waiting_.clear();
  path_.clear();
  for (std::uint32_t i = 0; i < tree.frustum_nodes; ++i) {
    if (question.mayCross(i)) {
      const Side side = sideOf(tree.nodes[i]);
      if (side == Side::kFront) {
        return State::kNothing;
      }
      // What lies in front of a frustum plane does not count, so that side need not be visited. Without
      // occluders the tree answers as the frustum's planes do one by one.
      if (side == Side::kBoth && tree.belowFrustum().isNode()) {
        path_.push_back({i, false});
      }
    }
  }
  return traverse(tree.belowFrustum());
}

namespace {

// Separating-axis test of a box, grown by a margin, and a set of points.
class SeparatingAxis {
 public:
  SeparatingAxis(std::span<const Vec3d> base, const Eye& eye, const EyeBox& box, double margin)
      : base_(base), eye_(eye), center_(box.center()), half_(box.half()), margin_(margin) {}

  // axis: any length.
  bool separates(const Vec3d& axis) const {
    const double c = dot(axis, center_);
    const double r = dot(abs(axis), half_);
    double low = 0.0, high = 0.0;  // of the pyramid; its apex is the eye at 0
    // How far a metre of depth on a line of sight leads along the axis. The divisor is 1 but for rounding.
    const double along = dot(axis, eye_.sight) / dot(eye_.forward, eye_.sight);
    for (std::size_t i = 0; i < base_.size(); ++i) {
      const double d = dot(axis, base_[i]);
      // Orthographic: from the base back to the camera's plane.
      const double other = eye_.orthographic ? d - along * dot(eye_.forward, base_[i]) : d;
      if (i == 0 && eye_.orthographic) {
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
  const Eye& eye_;
  Vec3d center_, half_;
  double margin_;
};

}  // namespace

bool disjointFromPyramid(const TreeData& tree, const ShadowLeaf& leaf, const EyeBox& box) {
  const OcclusionVolume& volume = tree.volumes.volumes[leaf.volume];
  const Eye& eye = tree.volumes.eye;
  const auto base = std::span(tree.corners).subspan(leaf.first_corner, leaf.corner_count);
  const double margin = supportMargin(volume, box.reach()) + kDepthMargin * volume.reach;
  const SeparatingAxis test(base, eye, box, margin);
  const std::array<Vec3d, 3> axes{Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)};
  for (const Vec3d& axis : axes) {
    if (test.separates(axis)) {
      return true;
    }
  }
  // The pyramid's side planes were tested on the way to the leaf, and the box crosses its base: the axes that
  // are left are products of edges.
  for (std::size_t i = 0; i < base.size(); ++i) {
    const Vec3d along = base[(i + 1) % base.size()] - base[i];
    const Vec3d up = eye.orthographic ? eye.sight : base[i];
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

}  // namespace sightline::occlusion
