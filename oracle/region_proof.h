#pragma once

// Proves that a box is hidden from all of a region, by one closed body or by one surface.
//
// It is the judge of baked sets, so it knows the scene's triangles only: no occluders that were merged from
// them, no pieces of them, and nothing of how a bake decides. What it cannot prove may still be hidden.
//
//   A body     is a part of an object's mesh, connected over edges, without a boundary. A point behind the
//              planes of all its triangles is inside: each triangle is seen from its back, so the solid
//              angles add up to more than nothing. These points are a convex set. If it meets the segments
//              from all corners of the region to all corners of the box, it meets every segment between them,
//              for the points that one convex set hides from an eye are convex, and so are the eyes from
//              which it hides a point. A segment that begins outside of the body enters it through a front.
//   A surface  is a set of triangles, each seen from one side, whose boundary misses the shaft: the convex
//              hull of the region and the box. If no triangle of it that is in the shaft meets the region or
//              the box, all segments cross it as often as one does, fronts counted 1 and backs -1.
//
// What hides one half of a region or of a target may be something else than what hides the other half. So a
// claim may be proved in parts: of boxes around pieces of the target's triangles, from pieces of the region.
//
// All numbers are doubles that carry a bound of their rounding. What is in doubt proves nothing, and neither
// does a region so far away that products overflow.

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "oracle/eye_region.h"
#include "sightline/scene/scene.h"

namespace sightline {

struct ProofMesh;
struct DoubleBox;
class TargetPieces;

struct RegionClaim {
  EyeRegion region;
  ObjectId target;             // is hidden from it
  ObjectId by{};               // whose triangles are tried; not valid: those that lines of sight meet
  double near_distance = 0.0;  // what is closer to the region hides nothing, metres
};

// Const functions may be called from several threads at once.
class RegionProof {
 public:
  // The scene's memory must outlive this object.
  explicit RegionProof(const SceneView& scene);
  ~RegionProof();
  RegionProof(RegionProof&&) noexcept;
  RegionProof& operator=(RegionProof&&) noexcept;

  // True only if the region holds no eye.
  static bool isEmpty(const EyeRegion& region);
  // True only if no point of the target's box is seen from any eye of the region.
  bool proves(const RegionClaim& claim) const;
  // True only if no point of the target's triangles is seen from any eye of the region: proved of the whole
  // target, or of each half of the region or of the triangles, halved up to so many times.
  bool provesInParts(const RegionClaim& claim, std::uint32_t divisions) const;
  // True if some segment from the region to the target's box surely meets no triangle of claim.by: then that
  // object alone does not hide the box.
  bool refutesObject(const RegionClaim& claim) const;
  // True if the segment surely meets no triangle of the object that hides anything.
  bool misses(const Vec3d& from, const Vec3d& to, ObjectId object) const;

 private:
  class Attempt;
  DoubleBox boundsOf(ObjectId object) const;
  bool provesPart(const RegionClaim& claim, const TargetPieces& target, std::uint32_t divisions) const;
  bool provesHalves(const RegionClaim& claim, const TargetPieces& target, std::uint32_t divisions) const;
  std::unique_ptr<const ProofMesh> mesh_;
};

}  // namespace sightline
