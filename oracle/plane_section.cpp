#include "oracle/plane_section.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "oracle/ray_scene.h"

namespace sightline {
namespace {

// The part of a convex outline with a * x + b * y >= c.
std::vector<PlanePoint> clipped(const std::vector<PlanePoint>& outline, double a, double b, double c) {
  return clippedWhere(outline, [&](const PlanePoint& p) { return a * p.x + b * p.y - c; });
}

bool before(const Vec3f& a, const Vec3f& b) {
  return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

}  // namespace

std::optional<PlaneSection> PlaneSection::through(const Vec3d& eye, const Vec3d& target,
                                                  const Vec3d& across) {
  PlaneSection section;
  section.origin_ = eye;
  const Vec3d sight = target - eye;
  if (!(length(sight) > 0.0)) {
    return std::nullopt;
  }
  section.x_axis_ = normalized(sight);
  const Vec3d up = across - section.x_axis_ * dot(across, section.x_axis_);
  if (!(length(up) > 1e-6 * length(across))) {
    return std::nullopt;
  }
  section.y_axis_ = normalized(up);
  section.normal_ = cross(section.x_axis_, section.y_axis_);
  return section;
}

void PlaneSection::cut(const SceneView& scene, const TriangleTree& tree, const EyePlaces& places,
                       ObjectId object, double near_distance) {
  exits_.clear(), targets_.clear(), blockers_.clear();
  cutRegion(places);
  if (exits_.empty()) {
    return;
  }
  // All lines of sight are in the box around region and object.
  const Box& bounds = scene.objects[object.value].bounds;
  const Vec3d low = min(places.region().min, Vec3d(bounds.min)),
              high = max(places.region().max, Vec3d(bounds.max));
  const auto inReach = [&](const Box& box) {
    return box.min.x <= high.x && box.min.y <= high.y && box.min.z <= high.z && box.max.x >= low.x &&
           box.max.y >= low.y && box.max.z >= low.z;
  };
  const auto visit = [&](std::uint32_t root, auto&& on_leaf) {
    std::vector<std::uint32_t> open;
    if (root != TriangleTree::kNoNode) {
      open.push_back(root);
    }
    while (!open.empty()) {
      const TriangleTree::Node& node = tree.node(open.back());
      open.pop_back();
      if (!mayCut(node.box) || !inReach(node.box)) {
        continue;
      }
      if (node.isLeaf()) {
        on_leaf(node);
      } else {
        open.insert(open.end(), {node.right, node.left});
      }
    }
  };
  visit(tree.rootOf(object), [&](const TriangleTree::Node& leaf) { cutTriangle(scene, leaf, targets_); });
  if (targets_.empty()) {
    return;
  }
  std::vector<Gate> opaque;
  visit(tree.root(), [&](const TriangleTree::Node& leaf) {
    if (leaf.object != object && occludes(scene, scene.objects[leaf.object.value])) {
      cutTriangle(scene, leaf, opaque);
    }
  });
  for (const Gate& gate : opaque) {
    keepBeyondNear(gate, near_distance);
  }
}

void PlaneSection::cutRegion(const EyePlaces& places) {
  const double reach = 4.0 * length(places.region().max - places.region().min);
  const PlanePoint middle = inPlane((places.region().min + places.region().max) * 0.5);
  outline_ = {{middle.x - reach, middle.y - reach},
              {middle.x + reach, middle.y - reach},
              {middle.x + reach, middle.y + reach},
              {middle.x - reach, middle.y + reach}};
  for (const HalfSpace& face : places.faces()) {
    outline_ = clipped(outline_, dot(face.normal, x_axis_), dot(face.normal, y_axis_),
                       face.offset - dot(face.normal, origin_));
  }
  if (outline_.size() < 3) {
    return;
  }
  for (std::size_t i = 0; i < outline_.size(); ++i) {
    exits_.push_back({outline_[(i + 1) % outline_.size()], outline_[i]});
  }
}

bool PlaneSection::mayCut(const Box& box) const {
  const Vec3d half = (Vec3d(box.max) - Vec3d(box.min)) * 0.5;
  return std::abs(dot(center(box) - origin_, normal_)) <= dot(half, abs(normal_)) * (1.0 + 1e-9) + 1e-9;
}

void PlaneSection::cutTriangle(const SceneView& scene, const TriangleTree::Node& leaf,
                               std::vector<Gate>& gates) const {
  std::array<Vec3f, 3> corners;
  std::array<double, 3> above{};
  for (std::uint32_t i = 0; i < 3; ++i) {
    corners[i] = scene.positions[scene.indices[leaf.first_index + i]];
    above[i] = dot(Vec3d(corners[i]) - origin_, normal_);
  }
  std::array<PlanePoint, 2> ends;
  std::size_t count = 0;
  for (std::size_t i = 0; i < 3 && count < 2; ++i) {
    std::size_t from = i, to = (i + 1) % 3;
    if ((above[from] >= 0.0) == (above[to] >= 0.0)) {
      continue;
    }
    if (before(corners[to], corners[from])) {
      std::swap(from, to);  // so that triangles that share the edge are cut at the same bits
    }
    const double s = above[from] / (above[from] - above[to]);
    ends[count++] = inPlane(Vec3d(corners[from]) + (Vec3d(corners[to]) - Vec3d(corners[from])) * s);
  }
  if (count < 2) {
    return;
  }
  const Vec3d normal = cross(Vec3d(corners[1]) - Vec3d(corners[0]), Vec3d(corners[2]) - Vec3d(corners[0]));
  // Lines across the gate run along this normal of it, from its front to its back.
  const double along =
      (ends[1].x - ends[0].x) * dot(normal, y_axis_) - (ends[1].y - ends[0].y) * dot(normal, x_axis_);
  const bool double_sided = scene.materialOf(scene.objects[leaf.object.value]).double_sided;
  if (double_sided || along < 0.0) {
    gates.push_back({ends[0], ends[1]});
  }
  if (double_sided || along > 0.0) {
    gates.push_back({ends[1], ends[0]});
  }
}

void PlaneSection::keepBeyondNear(const Gate& gate, double near_distance) {
  const PlanePoint d{gate.right.x - gate.left.x, gate.right.y - gate.left.y};
  double enter = 0.0, leave = 1.0;  // the part of the gate that is near
  for (std::size_t i = 0; i < outline_.size() && enter < leave; ++i) {
    const PlanePoint &a = outline_[i], &b = outline_[(i + 1) % outline_.size()];
    const double size = std::hypot(b.x - a.x, b.y - a.y);
    if (!(size > 0.0)) {
      continue;
    }
    const PlanePoint out{(b.y - a.y) / size, -(b.x - a.x) / size};
    const double beyond =
        out.x * (gate.left.x - a.x) + out.y * (gate.left.y - a.y) - near_distance * (1.0 + 1e-9);
    const double change = out.x * d.x + out.y * d.y;
    if (change > 0.0) {
      leave = std::min(leave, -beyond / change);
    } else if (change < 0.0) {
      enter = std::max(enter, -beyond / change);
    } else if (beyond > 0.0) {
      leave = -1.0;
    }
  }
  if (enter >= leave) {
    blockers_.push_back(gate);
    return;
  }
  const auto at = [&](double s) { return PlanePoint{gate.left.x + d.x * s, gate.left.y + d.y * s}; };
  if (enter > 0.0) {
    blockers_.push_back({gate.left, at(enter)});
  }
  if (leave < 1.0) {
    blockers_.push_back({at(leave), gate.right});
  }
}

}  // namespace sightline
