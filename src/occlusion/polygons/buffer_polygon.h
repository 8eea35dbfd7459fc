#pragma once

// Occluders as the rasteriser draws them into a depth buffer: clipped and projected polygons, with the edges
// at which they end and those at which other polygons go on. scene/pixel_view.h defines buffer space and
// reciprocal depth.

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "sightline/occluders/occluder_set.h"
#include "src/geometry/centre_spans.h"

namespace sightline::occlusion {

// A bound, in pixels, of the rounding error of an edge's computed place in the buffer; see
// docs/conservative.md.
constexpr double bufferRounding(std::uint32_t width, std::uint32_t height) {
  return 0x1p-18 * (static_cast<double>(width) + static_cast<double>(height));
}

enum class EdgeKind : std::uint8_t {
  kOpen,  // the occluder ends here: pixels that the edge crosses are not covered
  // Other occluders go on beyond, at least along parts of the edge. The other parts are open edges of their
  // own, BufferPolygons::gaps().
  kShared,
  kBorder,  // lies outside the buffer
};

// A segment in the buffer, in pixels of single precision.
struct BufferEdge {
  float low = 0.0f, high = 0.0f;    // least and greatest y
  float left = 0.0f, right = 0.0f;  // least and greatest x
  float x_at_low = 0.0f;
  float slope = 0.0f;   // dx / dy; 0 where low == high
  float margin = 0.0f;  // a pixel is clear of the edge only when it is farther away than this
  EdgeKind kind = EdgeKind::kOpen;
  std::int8_t side = 0;  // 1: the polygon lies to the left of the edge; -1: to the right; 0: horizontal edge

  bool flat() const { return low == high; }
};

// The reciprocal depth of a plane as a function of the pixel (x, y): at_origin + along_x * x + along_y * y.
// Conservative polygons: at most that of any point of the plane in the pixel, by more than the rounding of
// this sum to single precision. Exact polygons: that of the pixel's lower left corner.
struct ReciprocalDepthPlane {
  double at_origin = 0.0, along_x = 0.0, along_y = 0.0;
};

// A plane with bounds of its reciprocal depth over a polygon's image.
struct PolygonDepth {
  ReciprocalDepthPlane plane;
  float farthest = 0.0f, nearest = 0.0f;
};

// One occluder, or a convex body: the outline of all its faces that are seen.
struct BufferPolygon {
  static constexpr std::uint32_t kMaxPlanes = 4;
  static constexpr std::uint32_t kNoGroup = 0xffffffffu;

  OccluderId occluder;                           // of a body: the face that was chosen
  std::uint32_t first_edge = 0, edge_count = 0;  // its outline
  std::uint32_t gap_count = 0;                   // edges after those: the open parts of shared edges
  std::uint32_t first_corner = 0;                // as many corners as edges
  float low = 0.0f, high = 0.0f;                 // bounds of its image, pixels
  float left = 0.0f, right = 0.0f;
  float margin = 0.0f;                      // the greatest margin of its edges
  ReciprocalDepthPlane planes[kMaxPlanes];  // its reciprocal depth is the least of theirs
  std::uint32_t plane_count = 0;
  float farthest = 0.0f, nearest = 0.0f;  // bounds of its reciprocal depth
  // Polygons that share edges, directly or through others, have the same group; a body has none.
  std::uint32_t group = kNoGroup;

  // Adds a plane; farthest and nearest start at the largest float.
  void add(const PolygonDepth& depth) {
    planes[plane_count++] = depth.plane;
    farthest = std::min(farthest, depth.farthest);
    nearest = std::min(nearest, depth.nearest);
  }
};

// The polygons of one draw.
struct BufferPolygons {
  std::vector<BufferPolygon> polygons;
  std::vector<BufferEdge> edges;
  std::vector<geometry::PixelPoint> points;
  std::uint32_t considered = 0;  // chosen occluders, each body once; not all of them have polygons

  void clear() {
    polygons.clear();
    edges.clear();
    points.clear();
    considered = 0;
  }
  std::span<const BufferEdge> outline(const BufferPolygon& p) const {
    return std::span(edges).subspan(p.first_edge, p.edge_count);
  }
  std::span<const BufferEdge> gaps(const BufferPolygon& p) const {
    return std::span(edges).subspan(p.first_edge + p.edge_count, p.gap_count);
  }
  std::span<const geometry::PixelPoint> corners(const BufferPolygon& p) const {
    return std::span(points).subspan(p.first_corner, p.edge_count);
  }
};

}  // namespace sightline::occlusion
