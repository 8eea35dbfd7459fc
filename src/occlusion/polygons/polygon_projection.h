#pragma once

// The steps by which a polygon in camera space becomes a polygon of a depth buffer: clipping, edges with
// their margins, reciprocal depth.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "src/occlusion/polygons/buffer_polygon.h"
#include "src/scene/pixel_view.h"

namespace sightline::occlusion {

// A corner in camera space, with the kind of the edge that starts at it.
struct OutlineCorner {
  Vec3d position;
  EdgeKind kind = EdgeKind::kOpen;
};
// The corners of a convex polygon, and scratch for clipping it.
struct CameraOutline {
  std::vector<OutlineCorner> corners, scratch;
};

struct CameraSegment {
  Vec3d from, to;
};

// How polygons are made.
enum class PolygonForm : std::uint8_t {
  // Bodies are drawn as one, edges are shared, and depths are those of what triangles may lie behind.
  kConservative,
  kExact,  // each polygon is alone and as it is; for a CoverageRule
};

class PolygonProjection {
 public:
  PolygonProjection() = default;
  PolygonProjection(const scene::PixelView& view, PolygonForm form, std::uint32_t width, std::uint32_t height)
      : view_(view), form_(form), rounding_(bufferRounding(width, height)) {}

  const scene::PixelView& view() const { return view_; }
  PolygonForm form() const { return form_; }

  // Clips an outline to the depths beyond clip_depth (metres) and to a rectangle around the buffer. False: no
  // part of it is on the buffer.
  bool clip(double clip_depth, CameraOutline& outline) const;
  // Returns the part of a segment in the same volume.
  std::optional<CameraSegment> clip(double clip_depth, const CameraSegment& segment) const;

  // How far, in pixels, the image of a point may be off when the point is off by twice the inset (metres).
  float marginAt(double inset, double inverse_depth) const;
  // Returns a clipped segment as an open edge of an occluder with this inset.
  BufferEdge openEdge(const CameraSegment& segment, double inset) const;
  // Appends the corners and edges of a clipped outline. Returns its polygon, which has no planes yet.
  BufferPolygon appendOutline(OccluderId occluder, std::span<const OutlineCorner> corners, double inset,
                              BufferPolygons& polygons) const;
  // Returns the reciprocal depth of a plane over a polygon. support: relative to the eye, unit normal towards
  // it. slack: metres by which the conservative form moves it away.
  PolygonDepth depthOf(const Plane& support, double slack, const BufferPolygon& polygon,
                       std::span<const geometry::PixelPoint> corners) const;

 private:
  scene::PixelView view_;
  PolygonForm form_ = PolygonForm::kConservative;
  double rounding_ = 0.0;  // pixels
};

}  // namespace sightline::occlusion
