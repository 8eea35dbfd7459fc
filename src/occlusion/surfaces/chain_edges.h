#pragma once

// The chains of surfaces as edges in a depth buffer.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sightline/occluders/surface_set.h"
#include "src/occlusion/surfaces/boundary_edge.h"
#include "src/occlusion/surfaces/swept_lines.h"
#include "src/scene/pixel_view.h"

namespace sightline::occlusion {

// Projects the boundaries of groups, many edges at once. Equal points of the scene have equal images.
class ChainEdges {
 public:
  // clip_depth: camera space; what is nearer is left out.
  void begin(const SurfaceSet& set, const scene::PixelView& view, double clip_depth,
             const EdgeBuffer& buffer);

  // Adds a chain to the boundary of the group that the next endGroup() ends.
  void add(std::uint32_t chain, std::int32_t value);
  // The same for the line along which the clip plane cuts a triangle of the set, if it does. The part of the
  // triangle beyond the plane is the surface.
  void addCut(std::span<const std::uint32_t, 3> triangle, std::int32_t value);
  // Appends the group's boundary: those of its edges that matter to the buffer, or what is left of them
  // beyond the clip depth. Returns their number. Appends nothing if the boundary is not closed where the clip
  // plane cuts it, as in sets that findSurfaces() did not make.
  std::uint32_t endGroup(std::vector<BoundaryChain>& boundary);

  // The edges of the groups since begin() or forget().
  std::span<const BoundaryEdge> edges() const { return edges_; }
  void forget() { edges_.clear(); }

 private:
  // Edges of the scene, by coordinate: x, y and z of where they begin, then of where they end.
  static constexpr std::size_t kCoordinates = 6;
  // The line along which a triangle is cut, in place of one of these.
  struct Cut {
    std::uint32_t edge = 0;
    Vec3d from, to;  // camera space
  };

  // Where the clip plane cuts an edge of the scene.
  struct CutEnd {
    Vec3f a, b;              // the edge, ascending
    Vec3d at;                // camera space
    std::int64_t value = 0;  // of the lines that end there, less those that begin there
  };

  void forgetGroup();
  void makeRoom(std::size_t more);
  void clipAll();
  void clip(std::uint32_t edge, std::int32_t value);
  bool closeCut();
  bool link(CutEnd& a, CutEnd& b);
  Vec3d addCutEnd(const Vec3f& a, const Vec3f& b, std::int32_t value);
  void divideSwept();
  void divideSwept(std::size_t chain, std::uint32_t edge);
  void setLine(std::uint32_t edge, const Vec3d& from, const Vec3d& to);
  Vec3d toCamera(const Vec3f& point) const { return view_.toCamera(Vec3d(point) - view_.eye); }
  GridPoint pixelOf(const Vec3d& camera) const;

  const SurfaceSet* set_ = nullptr;
  scene::PixelView view_;
  double clip_depth_ = 0.0;
  EdgeBuffer buffer_;
  // These are of the group that was begun:
  std::vector<BoundaryChain> chains_;  // into ends_
  std::array<std::vector<float>, kCoordinates> ends_;
  std::uint32_t count_ = 0;  // of ends_ that are used
  std::vector<Cut> cuts_;
  std::vector<CutEnd> cut_ends_;
  GridLines lines_;
  // If the view is drawn for several viewers: the same lines, and how far they are swept.
  bool several_viewers_ = false;
  CameraLines camera_lines_;
  GridSweeps sweeps_;
  std::vector<BoundaryEdge> prepared_;

  std::vector<BoundaryEdge> edges_;
};

}  // namespace sightline::occlusion
