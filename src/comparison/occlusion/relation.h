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

#include "sightline/comparison/kept_planes.h"
#include "src/occlusion/planes/active_occluders.h"

namespace sightline::comparison {

using occlusion::ActiveOccluder;
using occlusion::Eye;
using occlusion::InsetEdge;

// The planes of four edges, two for each edge. The occluder lies in front of them.
struct PlaneQuad {
  double x[2][4] = {}, y[2][4] = {}, z[2][4] = {}, offset[2][4] = {};
};

struct Relation {
  OccluderId occluder;
  // The state of the occluder that the planes were made for.
  std::int16_t inset_exponent = 0;
  bool flipped = false;
  std::uint8_t edge_count = 0;
  bool behind = false;  // all of the box is behind the occluder's plane: [0] are supporting planes, [1]
                        // separating ones. Otherwise it crosses it, and both are separating ones
  // The result of the last evaluate().
  bool touches = false;  // the eye satisfies all separating planes: some of the box may be hidden
  std::uint64_t satisfied =
      0;               // supporting planes that the eye satisfies, a bit for each edge; if it touches
  double until = 0.0;  // the result holds until the eye's path is longer than this, metres

  bool fits(std::int16_t exponent, bool seen_from_back, std::uint32_t edges) const {
    return inset_exponent == exponent && flipped == seen_from_back && edge_count == edges;
  }
  std::uint64_t allEdges() const {
    return edge_count >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << edge_count) - 1;
  }
  std::uint64_t failing() const { return allEdges() & ~satisfied; }
  std::uint32_t quads() const { return (edge_count + 3u) / 4u; }
};

// On which side of the occluder's plane a box lies, as the eye sees it.
enum class PlaneSide : std::uint8_t { kFront, kCrossing, kBehind };
PlaneSide sideOf(const ActiveOccluder& occluder, const Box& box);

// Fills a relation and its planes, (edges + 3) / 4 of them. The box must not lie in front of the occluder.
void makeRelation(const ActiveOccluder& occluder, std::span<const InsetEdge> edges, const Box& box,
                  PlaneSide side, TangentSearch search, Relation& relation, std::span<PlaneQuad> planes);

// Finds which planes the eye satisfies now. path: length of the eye's path so far.
void evaluate(const Eye& eye, const ActiveOccluder& occluder, std::span<const PlaneQuad> planes, double path,
              Relation& relation);

}  // namespace sightline::comparison
