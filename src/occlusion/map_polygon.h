#pragma once

// Occluders as a map of pixels has them: clipped, projected, with the edges at which they end and those at
// which others go on. Map space and reciprocal depth: scene/pixel_view.h.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/occlusion/rasteriser.h"
#include "src/geometry/centre_spans.h"
#include "src/occlusion/eye_occluder.h"
#include "src/scene/pixel_view.h"

namespace sightline::occlusion {

// What is computed of an edge's place in the map is off by less than this, pixels; see docs/conservative.md.
constexpr double mapRounding(std::uint32_t width, std::uint32_t height) {
  return 0x1p-18 * (static_cast<double>(width) + static_cast<double>(height));
}

enum class EdgeKind : std::uint8_t {
  kOpen,    // the occluder ends here: what the edge crosses is not covered
  kSealed,  // others go on beyond, at least along parts of it; where they do not there is a MapEdge of its
            // own
  kBorder,  // off the map
};

// A segment in the map, single precision.
struct MapEdge {
  float low = 0.0f, high = 0.0f;    // least and greatest y
  float left = 0.0f, right = 0.0f;  // least and greatest x
  float x_at_low = 0.0f;
  float slope = 0.0f;   // dx / dy; 0 where low == high
  float margin = 0.0f;  // pixels: what comes so near is not clear of the edge
  EdgeKind kind = EdgeKind::kOpen;
  std::int8_t side = 0;  // the polygon lies to the right of it: -1; to the left: 1; horizontal: 0

  bool flat() const { return low == high; }
};

// ReciprocalDepth in pixel (x, y): at_origin + along_x * x + along_y * y. Inner coverage: at most that of any
// point of the plane in the pixel, by more than the rounding of this sum to single precision. Centre
// coverage: at the pixel's centre.
struct ReciprocalDepthPlane {
  double at_origin = 0.0, along_x = 0.0, along_y = 0.0;
};

// Of an occluder, or of a convex body: the outline of all its faces that are seen.
struct MapPolygon {
  static constexpr std::uint32_t kMaxPlanes = 4;

  OccluderId occluder;                           // of a body: the face that was chosen
  std::uint32_t first_edge = 0, edge_count = 0;  // of its outline
  std::uint32_t gap_count = 0;                   // edges after those: the open parts of sealed edges
  std::uint32_t first_corner = 0;                // as many as edges
  float low = 0.0f, high = 0.0f;                 // of its image
  float left = 0.0f, right = 0.0f;
  float margin = 0.0f;  // the greatest of its edges
  // Its reciprocal depth is the least of these.
  ReciprocalDepthPlane planes[kMaxPlanes];
  std::uint32_t plane_count = 0;
  float farthest = 0.0f, nearest = 0.0f;  // bounds of reciprocal depth over its image
  // Polygons that share sealed edges, directly or not, have the same.
  static constexpr std::uint32_t kNoGroup = 0xffffffffu;  // bodies
  std::uint32_t group = kNoGroup;
};

// Storage is kept from one use to the next.
class MapPolygons {
 public:
  // Of occluders that can be used from this view and may be on the map, in the order of `chosen`.
  void build(const PixelView& view, const RasterSettings& settings, const OccluderSet& set,
             std::span<const OccluderId> chosen);

  std::span<const MapEdge> outline(const MapPolygon& p) const {
    return std::span(edges).subspan(p.first_edge, p.edge_count);
  }
  std::span<const MapEdge> gaps(const MapPolygon& p) const {
    return std::span(edges).subspan(p.first_edge + p.edge_count, p.gap_count);
  }
  std::span<const MapPoint> corners(const MapPolygon& p) const {
    return std::span(points).subspan(p.first_corner, p.edge_count);
  }

  std::vector<MapPolygon> polygons;
  std::vector<MapEdge> edges;
  std::vector<MapPoint> points;
  std::uint32_t considered = 0;  // of the chosen ones, each and each body once; not all have polygons

 private:
  // A corner in camera space with the edge that starts at it.
  struct Corner {
    Vec3d position;
    EdgeKind kind = EdgeKind::kOpen;
  };
  static constexpr std::uint32_t kMaxBodyVertices = 32;
  struct Member {
    EyeOccluder seen;
    OccluderId chosen;   // of a body that is drawn by its faces: the one that stands for it
    double inset = 0.0;  // metres in its plane by which it is smaller than its outline
    std::uint32_t group = 0;
  };

  void takeMembers(const OccluderSet& set, std::span<const OccluderId> chosen,
                   const RasterSettings& settings);
  void addMember(const OccluderSet& set, OccluderId id, OccluderId chosen);
  double commonClipDepth() const;
  std::uint64_t openElementsOf(const OccluderSet& set, std::uint32_t member, const Outline& outline);
  void addPolygon(const OccluderSet& set, std::uint32_t member, double clip_depth,
                  const RasterSettings& settings);
  // As the occluder `id`. False: its faces are to be drawn one by one.
  bool addBody(const OccluderSet& set, OccluderId id, const OccluderBody& body,
               const RasterSettings& settings);
  bool findSilhouette(const OccluderSet& set, const OccluderBody& body, std::uint64_t seen);
  // Of the corners in clipped_.
  void startPolygon(OccluderId occluder, double inset, MapPolygon& polygon);
  bool clip(double clip_depth);
  void addGaps(const OccluderSet& set, const Member& member, std::uint32_t edge, std::uint64_t open);
  bool clipGap(const Vec3d& from, const Vec3d& to, double clip_depth, Vec3d& a, Vec3d& b) const;
  // support: relative to the eye, unit normal towards it; slack: metres that it is moved away.
  void addReciprocalDepth(const Plane& support, double slack, const RasterSettings& settings,
                          MapPolygon& polygon) const;
  float marginAt(double inset, double inverse_depth) const;
  std::uint32_t rootOf(std::uint32_t member);

  static constexpr std::uint32_t kNone = 0xffffffffu;
  PixelView view_;
  Eye eye_;
  double rounding_ = 0.0;  // pixels
  std::vector<Member> members_;
  std::vector<std::uint32_t> member_of_;  // by OccluderId, kNone between builds
  std::vector<bool> body_met_;            // by body, false between builds
  std::vector<std::uint32_t> bodies_met_;
  std::vector<Corner> clipped_, scratch_;
  std::vector<double> inverse_depths_;         // of clipped_; orthographic: 1
  Vec3d body_corners_[kMaxBodyVertices];       // of the body that is being added, camera space
  std::vector<std::pair<Vec3d, Vec3d>> gaps_;  // of the polygon that is being added, camera space
};

}  // namespace sightline::occlusion
