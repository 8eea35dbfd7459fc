#pragma once

// Splitting convex polygons by planes, on a stack of corners that a whole traversal shares.

#include <array>
#include <vector>

#include "src/occlusion/tree/occlusion_volume.h"

namespace sightline::occlusion {

// The width of the frustum's planes: no more than rounding, so that what touches the frustum is in it. Planes
// of shared edges are wider.
inline constexpr double kTouching = 0x1p-60;

// A polygon on the stack.
struct Piece {
  std::uint32_t first = 0, count = 0;
};

enum class Side : std::uint8_t {
  kBack,     // no corner in front
  kFront,    // no corner behind
  kBoth,     // split
  kOnPlane,  // all corners on the plane
};

struct SplitResult {
  Side side = Side::kOnPlane;
  Piece front, back;  // with kBoth: the parts, which lie on top of the stack
};

class PolygonStack {
 public:
  static constexpr std::uint32_t kMaxCorners = 128;

  std::vector<Corner> corners;

  std::span<Corner> of(Piece piece) { return std::span(corners).subspan(piece.first, piece.count); }
  std::span<const Corner> of(Piece piece) const {
    return std::span(corners).subspan(piece.first, piece.count);
  }

  // Splits a polygon. plane: unit normal. ref: the plane's name, or PlaneRef() for planes that edges cannot
  // lie in. A corner counts as on the plane within kOnPlane * (relative * l1Norm(corner) + scale); a polygon
  // reaches a side when a corner is four times as far there.
  //
  // New edges get ref as their plane and are marked as embedded. An old edge keeps its plane, and is marked
  // if it lies in this one, bounds the polygon towards the same side, and both planes are equally wide. A
  // polygon with an edge that was made by this very plane is on the side where that edge has it, whatever
  // rounding says of its corners. Polygons that would get too many corners are not split but reported as
  // kOnPlane with overflow set.
  SplitResult split(Piece piece, const Plane& plane, PlaneRef ref, double scale, double relative = 1.0);

  // The planes that PlaneRefs of corners name, and their VolumeBuilder::tolerances, of which those that
  // differ by no more than equal_tolerance count as equal; needed when split() is given named planes.
  const std::vector<Plane>* planes = nullptr;
  const std::vector<double>* tolerances = nullptr;
  double equal_tolerance = 0.0;
  bool overflow = false;

 private:
  // Whether an edge that lies in the plane bounds its polygon as the plane of the given name and side does,
  // and what is near to it goes to both sides as it does at the edge's own plane.
  bool agrees(const Corner& corner, const Plane& plane, PlaneRef ref, PlaneRef oriented) const;

  std::array<double, kMaxCorners> distance_{};
  std::array<std::int8_t, kMaxCorners> sign_{};
};

}  // namespace sightline::occlusion
