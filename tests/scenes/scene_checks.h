#pragma once

// Checks shared by the tests of the procedural scenes.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

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

// Counts the objects whose material is not opaque.
std::size_t countSeeThrough(const Scene& scene);

// Objects whose name ends with `end`.
std::vector<std::size_t> namesThatEndWith(const Scene& scene, std::string_view end);

// The objects whose names begin with `start`.
struct NamedCounts {
  std::size_t objects = 0;
  std::uint64_t triangles = 0;
};
NamedCounts countNamed(const Scene& scene, std::string_view start);

// The objects whose names begin with `start` (or are it, if whole_name), taken together.
struct SheetCounts {
  std::uint64_t open_edges = 0;     // edges without as many triangles in one direction as in the other
  std::uint64_t crowded_edges = 0;  // edges of more than two triangles
  std::size_t pieces = 0;           // sets of triangles that hang together by shared positions
};
SheetCounts countSheet(const Scene& scene, std::string_view start, bool whole_name = false);

// The largest height below a point of the objects whose names begin with `start`, of triangles that face
// upwards; -infinity if there is none. Only x and z of the point count unless `below` is set: then only what
// is lower than the point.
double heightOf(const Scene& scene, std::string_view start, const Vec3d& point, bool below = false);

// Returns an empty text if below every eye, at most `most` metres away, there is ground of the objects whose
// names begin with `start`. Otherwise returns the frame.
std::string whatLacksGround(const Scene& scene, const CameraPath& path, std::string_view start, double most);

// The cosine of the maximum angle between the viewing directions of consecutive frames.
double smallestTurnCosine(const CameraPath& path);
// The maximum distance between consecutive eyes, metres.
double longestStep(const CameraPath& path);

// What a walk through a landscape promises.
struct WalkLimits {
  double clearance = 0.0;    // metres between the camera and any triangle, at least
  std::string_view ground;   // what the names of the objects that are walked on begin with
  double most_height = 0.0;  // metres of the eye above the ground, at most
  double turn_cosine = 0.0;  // smallestTurnCosine() is greater
  double step = 0.0;         // metres; longestStep() is less
};
// Returns an empty text if the scene has one path, of 400 frames, that keeps the limits. Otherwise returns
// what is wrong.
std::string whatIsWrongWithWalk(const Scene& scene, const WalkLimits& limits);

}  // namespace sightline::scene_checks
