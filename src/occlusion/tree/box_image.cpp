// The image of a box, cut by the planes on the path to a leaf of an occlusion tree.
// Differs from Bittner, Havran, Slavik, CGI 1998, section 6.2 in: the paper's modified tree never splits what
// it classifies, so a box also comes to leaves that its image does not reach.

#include "src/occlusion/tree/box_image.h"

#include <algorithm>

#include "src/geometry/box_tangents.h"

namespace sightline::occlusion {

void BoxImage::begin(const EyeBox& box, const Eye& eye, double scale) {
  eye_ = &eye;
  // A corner far away may be the end of an edge that passes close by, so points of an orthographic image are
  // measured by the nearest one.
  reach_ = eye.orthographic ? box.farthest() : 1.0;
  scale_ = eye.orthographic ? scale : 0.0;
  on_plane_scale_ = eye.orthographic ? box.nearest() + scale : 0.0;
  stack_.overflow = false;
  stack_.corners.clear();
  parts_.clear();
  // An orthographic eye is infinitely far behind.
  const int region = eye.orthographic ? geometry::regionOfOrigin(eye.sight, eye.sight)
                                      : geometry::regionOfOrigin(box.min, box.max);
  const geometry::Silhouette& loop = geometry::silhouetteFrom(region);
  for (int i = 0; i < loop.count; ++i) {
    const Vec3d corner = geometry::cornerOf(box.min, box.max, loop.corners[static_cast<std::size_t>(i)]);
    stack_.corners.push_back({eye.orthographic ? corner : normalized(corner), PlaneRef{}, false});
  }
  if (!eye.orthographic) {
    measureDirections();
  }
  parts_.push_back({{0, static_cast<std::uint32_t>(stack_.corners.size())}, stack_.corners.size()});
}

// Every point p of the polygon has |p| >= p . middle, which is least at a corner.
void BoxImage::measureDirections() {
  Vec3d middle;
  for (const Corner& corner : stack_.corners) {
    middle += corner.position;
  }
  middle = normalized(middle);
  double nearest = 1.0;
  for (const Corner& corner : stack_.corners) {
    nearest = std::min(nearest, dot(middle, corner.position));
  }
  if (nearest > kNearest) {
    on_plane_scale_ = nearest;
  } else {
    stack_.corners.clear();
  }
}

void BoxImage::keepCuts(std::uint32_t count) {
  if (count < cutCount()) {
    parts_.resize(count + 1);
    stack_.corners.resize(parts_.back().corners_needed);
  }
}

bool BoxImage::cut(const TreeNode& node, bool front) {
  // Orthographic distances are of all sizes, and an edge is drawn in by a part of its own occluder's reach
  // alone: there each plane is taken as one of a shared edge, whose two sides overlap.
  const bool overlaps = node.tolerance != 0.0 || eye_->orthographic;
  const double width = overlaps ? overlapWidth(node.tolerance, reach_, *eye_, scale_) : 0.0;
  const Plane plane{node.plane.normal, node.plane.offset + (front ? width : -width)};
  Piece piece = parts_.back().piece;
  const SplitResult split = stack_.split(piece, plane, PlaneRef{}, on_plane_scale_, 0.0);
  if (split.side == Side::kBoth) {
    piece = front ? split.front : split.back;
  } else if (split.side == (front ? Side::kBack : Side::kFront)) {
    piece = {};
  }
  parts_.push_back({piece, stack_.corners.size()});
  return piece.count != 0 || parts_.front().piece.count == 0;  // cuts leave all of an image that is not known
}

}  // namespace sightline::occlusion
