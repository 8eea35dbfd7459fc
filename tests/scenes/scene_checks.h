#pragma once

// What the tests of the procedural scenes ask of any scene.

#include <cstdint>
#include <string>

#include "sightline/scene/scene.h"

namespace sightline::scene_checks {

// FNV-1a over positions, indices, objects and the frames of the walks, bit by bit.
std::uint64_t hashOf(const Scene& scene);

// Empty when everything is in order: indices in range, arrays of matching lengths, finite coordinates, bounds
// exact, objects that follow each other without gaps and have at least one triangle each; otherwise what is
// wrong.
std::string whatIsWrong(const Scene& scene);

// Part of the triangles whose area is next to nothing.
double degenerateShare(const Scene& scene);

struct SolidCounts {
  std::size_t closed = 0;      // objects whose every edge is shared by two triangles, once in each direction
  std::size_t inside_out = 0;  // closed ones with negative volume
};
SolidCounts countSolids(const Scene& scene);

// Whether every edge of the object is shared by as many triangles in one direction as in the other.
bool isClosed(const Scene& scene, const Object& object);
// By the divergence theorem; meaningful for closed objects. Cubic metres.
double volumeOf(const Scene& scene, const Object& object);

// Empty when the camera nowhere goes through a triangle and never has one nearer than clearance metres
// (transparent and alpha-tested ones count too); otherwise the frame and the object.
std::string whatIsHit(const Scene& scene, const CameraPath& path, double clearance);

// The largest angle between the looks of neighbouring frames, as its cosine; and the longest step, metres.
double smallestTurnCosine(const CameraPath& path);
double longestStep(const CameraPath& path);

}  // namespace sightline::scene_checks
