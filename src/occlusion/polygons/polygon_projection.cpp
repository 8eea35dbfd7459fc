#include "src/occlusion/polygons/polygon_projection.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "src/geometry/clip_convex.h"

namespace sightline::occlusion {
namespace {

// Polygons are clipped this many widths and heights of the buffer beyond its borders, so that coordinates
// stay small.
constexpr double kBeyond = 1.0;

constexpr float kWholeBuffer = 1e9f;  // a margin in pixels that leaves nothing of any buffer

// Five half-spaces, affine in camera space; positive inside.
struct ClipVolume {
  static constexpr int kPlanes = 5;
  static constexpr int kNear = 0;

  // beyond: so many widths and heights of the buffer around it.
  ClipVolume(const scene::PixelView& view, double clip_depth, double beyond)
      : left(view.middle_x + beyond * view.width),
        right(view.width - view.middle_x + beyond * view.width),
        bottom(view.middle_y + beyond * view.height),
        top(view.height - view.middle_y + beyond * view.height),
        scale_x(view.scale_x),
        scale_y(view.scale_y),
        depth(clip_depth),
        orthographic(view.orthographic) {}

  double distance(int plane, const Vec3d& c) const {
    const double w = orthographic ? 1.0 : c.z;
    switch (plane) {
      case kNear:
        return c.z - depth;
      case 1:
        return left * w + scale_x * c.x;
      case 2:
        return right * w - scale_x * c.x;
      case 3:
        return bottom * w + scale_y * c.y;
      default:
        return top * w - scale_y * c.y;
    }
  }
  // A bit for each plane that the point is beyond.
  unsigned outside(const Vec3d& c) const {
    const double w = orthographic ? 1.0 : c.z;
    const double x = scale_x * c.x, y = scale_y * c.y;
    return (c.z < depth ? 1u : 0u) | (x < -left * w ? 2u : 0u) | (x > right * w ? 4u : 0u) |
           (y < -bottom * w ? 8u : 0u) | (y > top * w ? 16u : 0u);
  }

  double left, right, bottom, top;  // from the forward axis, pixels
  double scale_x, scale_y, depth;
  bool orthographic;
};

BufferEdge edgeBetween(const geometry::PixelPoint& a, const geometry::PixelPoint& b, EdgeKind kind,
                       float margin) {
  const bool rises = b.y > a.y;
  const geometry::PixelPoint &low = rises ? a : b, &high = rises ? b : a;
  BufferEdge edge;
  edge.low = static_cast<float>(low.y);
  edge.high = static_cast<float>(high.y);
  edge.left = static_cast<float>(std::min(a.x, b.x));
  edge.right = static_cast<float>(std::max(a.x, b.x));
  edge.x_at_low = static_cast<float>(low.x);
  edge.margin = margin;
  edge.kind = kind;
  if (!edge.flat()) {
    // The rise is that of the rounded ends: in a row that has all of a nearly level edge, the slope times
    // their difference must lead from one end to the other.
    const double rise = static_cast<double>(edge.high) - static_cast<double>(edge.low);
    edge.slope = static_cast<float>((high.x - low.x) / rise);
    edge.side = rises ? 1 : -1;
  }
  return edge;
}

}  // namespace

bool PolygonProjection::clip(double clip_depth, CameraOutline& outline) const {
  // The mesh may go on a little beyond a shared edge: then it is on the buffer although the polygon is not.
  const bool shared =
      std::any_of(outline.corners.begin(), outline.corners.end(),
                  [](const OutlineCorner& corner) { return corner.kind == EdgeKind::kShared; });
  const ClipVolume volume(view_, clip_depth, kBeyond);
  const ClipVolume buffer = shared ? volume : ClipVolume(view_, clip_depth, 0.0);
  unsigned outside_all = ~0u, outside_some = 0;
  for (const OutlineCorner& corner : outline.corners) {
    outside_all &= buffer.outside(corner.position);
    outside_some |= volume.outside(corner.position);
  }
  if (outside_all != 0) {
    return false;
  }
  for (int plane = 0; plane < ClipVolume::kPlanes; ++plane) {
    const OutlineCorner cut{{}, plane == ClipVolume::kNear ? EdgeKind::kOpen : EdgeKind::kBorder};
    if ((outside_some >> plane & 1) != 0 &&
        !geometry::clipConvex(outline.corners, outline.scratch, cut,
                              [&](const Vec3d& p) { return volume.distance(plane, p); })) {
      return false;
    }
  }
  return true;
}

std::optional<CameraSegment> PolygonProjection::clip(double clip_depth, const CameraSegment& segment) const {
  const ClipVolume volume(view_, clip_depth, kBeyond);
  const Vec3d along = segment.to - segment.from;
  double first = 0.0, last = 1.0;
  for (int plane = 0; plane < ClipVolume::kPlanes; ++plane) {
    const double at_from = volume.distance(plane, segment.from), at_to = volume.distance(plane, segment.to);
    if (at_from < 0.0 && at_to < 0.0) {
      return std::nullopt;
    }
    if (at_from < 0.0) {
      first = std::max(first, at_from / (at_from - at_to));
    } else if (at_to < 0.0) {
      last = std::min(last, at_from / (at_from - at_to));
    }
  }
  if (!(first <= last)) {
    return std::nullopt;
  }
  return CameraSegment{segment.from + along * first, segment.from + along * last};
}

float PolygonProjection::marginAt(double inset, double inverse_depth) const {
  if (!view_.orthographic && !(inset * inverse_depth < 0.1)) {
    return kWholeBuffer;
  }
  const double stretch =
      view_.orthographic
          ? std::max(view_.scale_x, view_.scale_y)
          : std::max(view_.scale_x + view_.reachX(), view_.scale_y + view_.reachY()) * inverse_depth;
  return static_cast<float>(4.0 * rounding_ + 2.25 * inset * stretch);
}

BufferEdge PolygonProjection::openEdge(const CameraSegment& segment, double inset) const {
  const Vec3d &a = segment.from, &b = segment.to;
  return edgeBetween({view_.pixelX(a), view_.pixelY(a)}, {view_.pixelX(b), view_.pixelY(b)}, EdgeKind::kOpen,
                     marginAt(inset, 1.0 / std::min(a.z, b.z)));
}

BufferPolygon PolygonProjection::appendOutline(OccluderId occluder, std::span<const OutlineCorner> corners,
                                               double inset, BufferPolygons& polygons) const {
  BufferPolygon polygon;
  polygon.occluder = occluder;
  polygon.first_edge = static_cast<std::uint32_t>(polygons.edges.size());
  polygon.first_corner = static_cast<std::uint32_t>(polygons.points.size());
  polygon.edge_count = static_cast<std::uint32_t>(corners.size());
  polygon.low = polygon.left = polygon.farthest = polygon.nearest = std::numeric_limits<float>::max();
  polygon.high = polygon.right = -std::numeric_limits<float>::max();
  for (const OutlineCorner& corner : corners) {
    const double inverse = view_.inverseDepth(corner.position);
    polygons.points.push_back(
        {view_.pixelX(corner.position, inverse), view_.pixelY(corner.position, inverse)});
  }
  const std::span<const geometry::PixelPoint> points = polygons.corners(polygon);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const std::size_t next = i + 1 < corners.size() ? i + 1 : 0;
    const double inverse_depth =
        std::max(view_.inverseDepth(corners[i].position), view_.inverseDepth(corners[next].position));
    const BufferEdge edge =
        edgeBetween(points[i], points[next], corners[i].kind, marginAt(inset, inverse_depth));
    polygons.edges.push_back(edge);
    polygon.low = std::min(polygon.low, edge.low);
    polygon.high = std::max(polygon.high, edge.high);
    polygon.left = std::min(polygon.left, edge.left);
    polygon.right = std::max(polygon.right, edge.right);
    polygon.margin = std::max(polygon.margin, edge.margin);
  }
  return polygon;
}

PolygonDepth PolygonProjection::depthOf(const Plane& support, double slack, const BufferPolygon& polygon,
                                        std::span<const geometry::PixelPoint> corners) const {
  const bool conservative = form_ == PolygonForm::kConservative;
  const Vec3d n = view_.normalToCamera(support.normal);
  const double offset = support.offset + (conservative ? slack : 0.0);
  const double scale = view_.orthographic ? 1.0 / n.z : -1.0 / offset;
  ReciprocalDepthPlane plane;
  plane.along_x = scale * n.x / view_.scale_x;
  plane.along_y = scale * n.y / view_.scale_y;
  plane.at_origin = scale * (view_.orthographic ? offset : n.z) - plane.along_x * view_.middle_x -
                    plane.along_y * view_.middle_y;
  double min = std::numeric_limits<double>::infinity(), max = -min, sums = 0.0;
  for (const geometry::PixelPoint& p : corners) {
    const double x = plane.along_x * p.x, y = plane.along_y * p.y;
    min = std::min(min, plane.at_origin + x + y);
    max = std::max(max, plane.at_origin + x + y);
    sums = std::max(sums, std::abs(x) + std::abs(y));
  }
  // In an off-centre view the terms of at_origin may be larger than all values over the buffer.
  const double beside = std::abs(plane.along_x * (view_.middle_x - 0.5 * view_.width)) +
                        std::abs(plane.along_y * (view_.middle_y - 0.5 * view_.height));
  const double slope = std::abs(plane.along_x) + std::abs(plane.along_y);
  const double width = std::abs(plane.along_x) * (polygon.right - polygon.left);
  const double rounding = 0x1p-22 * (std::max(std::abs(min), std::abs(max)) + width + 4.0 * slope) +
                          0x1p-50 * (std::abs(plane.at_origin) + sums + beside);
  if (conservative) {
    plane.at_origin += std::min(plane.along_x, 0.0) + std::min(plane.along_y, 0.0) - rounding;
  }
  return {plane, static_cast<float>(min - rounding), static_cast<float>(max + rounding)};
}

}  // namespace sightline::occlusion
