#pragma once

// The chosen occluders as seen from one eye: facing it, beyond the near plane, with shadow planes whose
// rounding is on the visible side. This is the first stage of building an occlusion tree.

#include <cstdint>
#include <span>
#include <vector>

#include "src/occlusion/eye_occluder.h"

namespace sightline::occlusion {

// A plane that may be used from both sides. Occluders lie behind (at negative values of) their own shadow
// planes.
struct PlaneRef {
  std::uint32_t bits = 0xffffffffu;

  static PlaneRef make(std::size_t plane, bool flipped) {
    return {static_cast<std::uint32_t>(plane << 1) | (flipped ? 1u : 0u)};
  }
  std::uint32_t plane() const { return bits >> 1; }
  bool flipped() const { return (bits & 1u) != 0; }
  PlaneRef other() const { return {bits ^ 1u}; }
  bool samePlane(PlaneRef b) const { return plane() == b.plane(); }
};

// A corner of a polygon and the edge to the next corner. Positions are relative to the eye.
struct Corner {
  Vec3d position;
  PlaneRef edge;          // the polygon lies behind it
  bool embedded = false;  // the edge lies in a plane of the tree above: no node needed
  bool open = false;      // its plane is drawn in: only that very plane can stand for it
};

// A place where an edge changes from being shared to being open. The polygon is cut there, so that the margin
// of the open part does not make a gap along the shared part.
struct EdgeCut {
  std::uint32_t volume = 0;
  Plane plane;              // across the edge, relative to the eye
  PlaneRef inset, on_line;  // the planes of the edge's open parts and of its shared ones
};

struct OcclusionVolume {
  OccluderId occluder;       // in its own set
  Plane support;             // the polygon's plane, unit normal towards the eye, relative to the eye
  double depth_slack = 0.0;  // metres by which a point must be behind it, in addition to kDepthMargin
  Vec3d centroid;            // of the unclipped polygon, relative to the eye
  std::uint32_t first_corner = 0, corner_count = 0;
  double reach = 0.0;  // largest l1Norm() of a corner, metres
};

class VolumeBuilder {
 public:
  // Fills volumes, corners and planes, set by set. Occluders that cannot be used from here get no volume.
  // Shared edges are watertight between occluders of one set only.
  void build(const View& view, std::span<const ChosenOccluders> sets);

  // Adds a shadow plane.
  PlaneRef addPlane(const Plane& plane, double tolerance = 0.0);

  Eye eye;
  std::vector<OcclusionVolume> volumes;
  std::vector<Corner> corners;
  std::vector<Plane> planes;  // unit normals
  // By plane: how far from it both sides must be visited, relative to the distance from the eye (perspective)
  // or in metres (orthographic). For planes of shared edges, the mesh's own vertices may lie that far away,
  // with a gap between two occluders beyond. 0 for all other planes, which are drawn in instead.
  std::vector<double> tolerances;
  std::vector<EdgeCut> cuts;                // volume after volume
  std::vector<std::size_t> volumes_of_set;  // by set: how many of the volumes are of it
  double reach = 0.0;                       // the largest reach of the volumes, metres

 private:
  void addSet(const OccluderSet& set, std::span<const OccluderId> chosen);
  bool fitsInset(const OccluderSet& set, const EyeOccluder& candidate) const;
  void addVolume(const OccluderSet& set, const EyeOccluder& candidate);
  void addEdge(const OccluderSet& set, const EyeOccluder& candidate, const Outline& outline);
  bool addRuns(const OccluderSet& set, const EyeOccluder& candidate, const Outline& outline,
               std::uint64_t open, PlaneRef on_line);
  std::uint32_t clipNear(std::uint32_t first, std::uint32_t count, double depth);
  Plane insetPlane(const EyeOccluder& candidate, const Outline& outline, double& sine) const;

  static constexpr std::uint32_t kNone = 0xffffffffu;
  std::vector<EyeOccluder> candidates_;
  std::vector<std::uint32_t> candidate_of_;   // by OccluderId, kNone between sets
  std::vector<std::uint32_t> plane_of_line_;  // by line, kNone between sets
  std::vector<std::uint32_t> used_lines_;
  std::vector<Corner> clipped_;
  std::uint32_t candidate_first_corner_ = 0;  // of the volume that is being added
};

}  // namespace sightline::occlusion
