#pragma once

// Checks shared by the tests of the procedural scenes.

#include <cstdint>
#include <string>

#include "sightline/scene/scene.h"

namespace sightline::scene_checks {

// FNV-1a hash of all bits of positions, indices, objects and the frames of the camera paths.
std::uint64_t hashOf(const Scene& scene);

// Returns an empty text if everything is valid: indices in range, arrays of matching lengths, finite
// coordinates, exact bounds, objects that follow each other without gaps and have at least one triangle each.
// Otherwise returns what is wrong.
std::string whatIsWrong(const Scene& scene);

// Fraction of the triangles whose area is almost zero.
double degenerateShare(const Scene& scene);

struct SolidCounts {
  std::size_t closed = 0;      // objects whose every edge is shared by two triangles, once in each direction
  std::size_t inside_out = 0;  // closed ones with negative volume
};
SolidCounts countSolids(const Scene& scene);

// True if every edge of the object is shared by as many triangles in one direction as in the other.
bool isClosed(const Scene& scene, const Object& object);
// Volume by the divergence theorem, cubic metres; meaningful for closed objects.
double volumeOf(const Scene& scene, const Object& object);

// Returns an empty text if the camera never passes through a triangle and never comes closer to one than
// clearance metres (including transparent and alpha-tested ones). Otherwise returns the frame and the object.
std::string whatIsHit(const Scene& scene, const CameraPath& path, double clearance);

// The cosine of the maximum angle between the viewing directions of consecutive frames.
double smallestTurnCosine(const CameraPath& path);
// The maximum distance between consecutive eyes, metres.
double longestStep(const CameraPath& path);

}  // namespace sightline::scene_checks
