#pragma once

// Occlusion relations: the supporting and separating planes of one occluder and one box.
//
// Based on: Coorg, Teller. Real-Time Occlusion Culling for Models with Large Occluders. I3D 1997, sections 3
// and 3.1. Differs from the paper in: planes go through the occluder's outline drawn in by a margin; a
// relation knows how far the eye may move before any sign can change; boxes that cross the occluder's plane
// have separating planes too.
//
// A plane goes through an edge of the occluder and a vertex of the box, so it does not depend on the eye. It
// is stored relative to the occluder's first vertex, with a normal of the length sin(beta), where beta is the
// angle at the edge between edge and vertex. So the value at the eye has a rounding error of at most 2^-49
// times the distances involved, however badly conditioned the plane is.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/occlusion/supporting_planes.h"
#include "src/occlusion/eye_occluder.h"
#include "src/occlusion/eye_planes.h"

namespace sightline::occlusion {

// The planes of four edges, two an edge. The occluder lies in front of them.
struct PlaneQuad {
  double x[2][4] = {}, y[2][4] = {}, z[2][4] = {}, offset[2][4] = {};
};

struct Relation {
  OccluderId occluder;
  // What the planes were made for.
  std::int16_t inset_exponent = 0;
  bool flipped = false;
  std::uint8_t edge_count = 0;
  bool behind = false;  // all of the box is behind the occluder's plane: [0] are supporting planes, [1]
                        // separating ones. Otherwise it crosses it, and both are separating ones
  // What was found at the last look.
  bool touches = false;         // satisfies all separating planes: some of the box may be hidden
  std::uint64_t satisfied = 0;  // supporting planes, a bit an edge; when it touches
  double until = 0.0;           // this holds while the eye's path is not longer than that, metres

  bool fits(std::int16_t exponent, bool seen_from_back, std::uint32_t edges) const {
    return inset_exponent == exponent && flipped == seen_from_back && edge_count == edges;
  }
  std::uint64_t allEdges() const {
    return edge_count >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << edge_count) - 1;
  }
  std::uint64_t failing() const { return allEdges() & ~satisfied; }
  std::uint32_t quads() const { return (edge_count + 3u) / 4u; }
};

// An edge of the outline, drawn in; relative to the occluder's first vertex.
struct InsetEdge {
  Vec3d point, direction;  // unit
};

// An occluder in use for one view.
struct Member {
  EyeOccluder seen;
  std::uint32_t set = 0;   // its set, by the number in SupportingPlanes::build()
  Vec3d origin;            // its first vertex, scene space
  Vec3d eye;               // relative to the origin; orthographic: the direction to the eye
  double eye_w = 1.0;      // 0: orthographic
  double threshold = 0.0;  // a value above it is surely positive
  double inset = 0.0;      // metres, 2^inset_exponent: at least seen.inset
  std::int16_t inset_exponent = 0;
  std::uint16_t edge_count = 0;
  bool near_clipped = false;
  Plane near_cut;  // through the eye, where the near plane cuts it; what is left lies behind; relative to the
                   // eye
  std::uint32_t first_edge = 0;        // into the inset edges of all members
  std::uint32_t first_seam = kNotYet;  // into the seams of all members, once they were asked for
  std::uint64_t sealable = 0;          // edges that have a seam, a bit each; likewise

  static constexpr std::uint32_t kNotYet = 0xffffffffu;
};

// Nothing where the occluder can't be used.
std::optional<Member> makeMember(const Eye& eye, const OccluderSet& set, OccluderId id);

// The occluder's edges, counter-clockwise from its front. Appends Occluder::vertex_count of them.
void appendInsetEdges(const OccluderSet& set, const Member& member, std::vector<InsetEdge>& edges);

// On which side of the occluder's plane a box lies, as the eye sees it.
enum class PlaneSide : std::uint8_t { kFront, kCrossing, kBehind };
PlaneSide sideOf(const Member& member, const Box& box);

// Fills a relation and its planes; the box does not lie in front.
void makeRelation(const Member& member, std::span<const InsetEdge> edges, const Box& box, PlaneSide side,
                  TangentSearch search, Relation& relation, std::span<PlaneQuad> planes);

// Looks where the eye is. path: its length so far.
void evaluate(const Member& member, std::span<const PlaneQuad> planes, double path, Relation& relation);

// The occluder as lookPast() needs it, what the near plane clips left out; appends its planes. edges: its
// own.
EyeShape eyeShapeOf(const Eye& eye, const Member& member, std::span<const InsetEdge> edges,
                    std::vector<EyeQuad>& quads);

}  // namespace sightline::occlusion
