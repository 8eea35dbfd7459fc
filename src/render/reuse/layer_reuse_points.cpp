#include "src/render/reuse/layer_reuse_points.h"

#include <algorithm>
#include <limits>

#include "src/geometry/clip_convex.h"

namespace sightline::render {
namespace {

constexpr std::size_t kSidePlanes = 4;  // a frustum's first planes; near and far follow

struct Corner {
  Vec3d position;
};

// The plane in the space that m maps from.
Plane pulledBack(const Plane& plane, const Mat4& m) {
  const auto column = [&](int i) { return Vec3d(m(0, i), m(1, i), m(2, i)); };
  return {{dot(plane.normal, column(0)), dot(plane.normal, column(1)), dot(plane.normal, column(2))},
          plane.evaluate(column(3))};
}

struct Bounds {
  Vec3d min{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
            std::numeric_limits<double>::infinity()};
  Vec3d max = -min;

  explicit Bounds(std::span<const Vec3d> points) {
    for (const Vec3d& p : points) {
      min = sightline::min(min, p);
      max = sightline::max(max, p);
    }
  }
};

// Whether all corners lie beyond one of the frustum's planes.
bool isBeyond(std::span<const Vec3d> corners, const Mat4& m, const Frustum& frustum) {
  return std::any_of(frustum.planes.begin(), frustum.planes.end(), [&](const Plane& plane) {
    return std::all_of(corners.begin(), corners.end(),
                       [&](const Vec3d& corner) { return plane.evaluate(transformPoint(m, corner)) < 0.0; });
  });
}

bool isInside(std::span<const Vec3d> corners, const Mat4& m, const Frustum& frustum) {
  for (const Vec3d& corner : corners) {
    const Vec3d p = transformPoint(m, corner);
    for (const Plane& plane : frustum.planes) {
      if (!(plane.evaluate(p) >= 0.0)) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace

std::vector<std::size_t> extremesOf(std::span<const Vec3d> points) {
  const Bounds bounds(points);
  const Vec3d size = bounds.max - bounds.min;
  const auto unit = [](double s) { return s > 0.0 ? 1.0 / s : 0.0; };
  const Vec3d scale(unit(size.x), unit(size.y), unit(size.z));
  std::vector<std::size_t> chosen;
  for (int d = 0; d < 27 && !points.empty(); ++d) {
    const int x = d % 3 - 1, y = d / 3 % 3 - 1, z = d / 9 - 1;
    const Vec3d direction(x * scale.x, y * scale.y, z * scale.z);
    if (direction == Vec3d()) {
      continue;
    }
    const auto nearer = [&](const Vec3d& a, const Vec3d& b) {
      return dot(direction, a - bounds.min) < dot(direction, b - bounds.min);
    };
    chosen.push_back(
        static_cast<std::size_t>(std::max_element(points.begin(), points.end(), nearer) - points.begin()));
  }
  if (chosen.empty() && !points.empty()) {
    chosen.push_back(0);  // all points lie in one place
  }
  std::sort(chosen.begin(), chosen.end());
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  return chosen;
}

PictureView::PictureView(const View& view, std::uint32_t width, std::uint32_t height)
    : view_(view), frustum_(frustumOf(view)), width_(width), height_(height) {
  const double half_height = view.orthographic ? 0.5 * view.ortho_height : view.tan_half_fovy;
  scale_y_ = 0.5 * height / half_height;
  scale_x_ = 0.5 * width / (half_height * view.aspect);
}

std::optional<PicturePoint> PictureView::find(const Vec3d& point_scene) const {
  const Vec3d relative = point_scene - view_.eye;
  const double depth = dot(relative, view_.forward);
  const double divisor = view_.orthographic ? 1.0 : depth;
  const PicturePoint at{
      0.5 * width_ * (1.0 - view_.shift_x) + scale_x_ * dot(relative, view_.right) / divisor,
      0.5 * height_ * (1.0 + view_.shift_y) - scale_y_ * dot(relative, view_.up) / divisor};
  // Corners that were clipped at these planes lie a little before or behind them.
  constexpr double kSlack = 1e-9;
  const bool is_between = depth >= view_.z_near * (1.0 - kSlack) && depth <= view_.z_far * (1.0 + kSlack);
  if (!is_between || !std::isfinite(at.x) || !std::isfinite(at.y)) {
    return std::nullopt;
  }
  return at;
}

LayerShapes::LayerShapes(const SceneView& scene)
    : positions_(scene.positions.begin(), scene.positions.end()),
      indices_(scene.indices.begin(), scene.indices.end()) {
  std::vector<Vec3d> vertices;
  for (const Object& object : scene.objects) {
    Shape& shape = shapes_.emplace_back();
    shape.first_index = object.first_index;
    shape.index_count = object.index_count;
    vertices.clear();
    for (const std::uint32_t index : scene.indicesOf(object)) {
      vertices.emplace_back(positions_[index]);
    }
    const Bounds bounds(vertices);
    for (std::size_t i = 0; i < shape.corners.size(); ++i) {
      shape.corners[i] = {i & 1 ? bounds.max.x : bounds.min.x, i & 2 ? bounds.max.y : bounds.min.y,
                          i & 4 ? bounds.max.z : bounds.min.z};
    }
    for (const std::size_t i : extremesOf(vertices)) {
      shape.extremes.push_back(vertices[i]);
    }
  }
}

template <typename Visit>
void LayerShapes::clipTriangles(const Shape& shape, const Mat4& scene_from_stored, const Frustum& frustum,
                                Visit&& visit) const {
  std::array<Plane, 6> planes;
  std::transform(frustum.planes.begin(), frustum.planes.end(), planes.begin(),
                 [&](const Plane& plane) { return pulledBack(plane, scene_from_stored); });
  std::vector<Corner> polygon, scratch;
  for (std::uint32_t i = 0; i < shape.index_count; i += 3) {
    polygon.clear();
    for (std::uint32_t k = 0; k < 3; ++k) {
      polygon.push_back({Vec3d(positions_[indices_[shape.first_index + i + k]])});
    }
    bool cut_in_depth = false;
    for (std::size_t plane = 0; plane < planes.size() && !polygon.empty(); ++plane) {
      const auto distance = [&](const Vec3d& p) { return planes[plane].evaluate(p); };
      cut_in_depth |= plane >= kSidePlanes &&
                      std::any_of(polygon.begin(), polygon.end(),
                                  [&](const Corner& c) { return !(distance(c.position) >= 0.0); });
      geometry::clipConvex(polygon, scratch, {}, distance);
    }
    if (!visit(polygon, cut_in_depth)) {
      return;
    }
  }
}

bool LayerShapes::isSeen(ObjectId object, const Mat4& scene_from_stored, const Frustum& frustum) const {
  const Shape& shape = shapes_[object.value];
  if (shape.index_count == 0 || isBeyond(shape.corners, scene_from_stored, frustum)) {
    return false;
  }
  bool is_seen = isInside(shape.corners, scene_from_stored, frustum);
  if (!is_seen) {
    clipTriangles(shape, scene_from_stored, frustum, [&](const std::vector<Corner>& polygon, bool) {
      is_seen = !polygon.empty();
      return !is_seen;
    });
  }
  return is_seen;
}

LayerPoints LayerShapes::pointsOf(std::span<const ObjectId> objects, std::span<const Mat4> scene_from_stored,
                                  const PictureView& view) const {
  LayerPoints layer;
  for (const ObjectId object : objects) {
    const Shape& shape = shapes_[object.value];
    const Mat4& m = scene_from_stored[object.value];
    if (shape.index_count == 0 || isBeyond(shape.corners, m, view.frustum())) {
      layer.unseen.push_back(object);
    } else if (!isInside(shape.corners, m, view.frustum())) {
      addClipped(object, m, view, layer);
    } else {
      for (const Vec3d& position : shape.extremes) {
        if (const std::optional<PicturePoint> at = view.find(transformPoint(m, position))) {
          layer.points.push_back({object, position});
          layer.seen_at.push_back(*at);
        }
      }
    }
  }
  return layer;
}

void LayerShapes::addClipped(ObjectId object, const Mat4& scene_from_stored, const PictureView& view,
                             LayerPoints& layer) const {
  constexpr double kAtSide = 1e-3;  // pixels
  std::vector<Vec3d> corners, seen;
  clipTriangles(shapes_[object.value], scene_from_stored, view.frustum(),
                [&](const std::vector<Corner>& polygon, bool cut_in_depth) {
                  layer.cut_in_depth |= cut_in_depth;
                  for (const Corner& corner : polygon) {
                    corners.push_back(corner.position);
                  }
                  return true;
                });
  std::size_t kept = 0;
  for (const Vec3d& corner : corners) {
    const Vec3d point = transformPoint(scene_from_stored, corner);
    const std::optional<PicturePoint> at = view.find(point);
    if (!at) {
      continue;
    }
    layer.cut[kLeftSide] |= at->x < kAtSide;
    layer.cut[kRightSide] |= at->x > view.width_ - kAtSide;
    layer.cut[kTopSide] |= at->y < kAtSide;
    layer.cut[kBottomSide] |= at->y > view.height_ - kAtSide;
    // In these three coordinates, place in the picture and reciprocal depth, planes stay planes.
    const double depth = dot(point - view.view_.eye, view.view_.forward);
    seen.emplace_back(at->x, at->y, view.view_.orthographic ? -depth : 1.0 / depth);
    corners[kept++] = corner;
  }
  if (seen.empty()) {
    layer.unseen.push_back(object);
  }
  for (const std::size_t i : extremesOf(seen)) {
    layer.points.push_back({object, corners[i]});
    layer.seen_at.push_back({seen[i].x, seen[i].y});
  }
}

}  // namespace sightline::render
