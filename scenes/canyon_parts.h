#pragma once

// The pieces of the canyon: the course of the valley, its terrain, and the aircraft that fly in it. Plan
// space.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "scenes/mesh_builder.h"
#include "scenes/moving_scene.h"
#include "scenes/placement.h"

namespace sightline::scenes::canyon {

inline constexpr double kSize = 720.0;  // side of the terrain, which is centred on the origin; metres

enum Class : std::uint32_t { kAircraft, kTerrain, kSky };

// The valley's centre line at an easting x, as y = middle(x).
struct ValleyPoint {
  double middle = 0.0, slope = 0.0, bend = 0.0;  // the function and its first two derivatives
};
ValleyPoint valleyAt(double x);

// The terrain: about 2,473 triangles, without the corners of the square. World space.
Scene terrainMesh(std::uint32_t seed);

// The six parts of an aircraft, each in its own space. The space of body, wing, engine and tail is the
// aircraft's: it looks along x, and y is up. Hinge and rudder turn about their own y axis.
inline constexpr std::uint32_t kAircraftParts = 6;
enum AircraftPart : std::uint32_t { kBody, kWing, kEngine, kTail, kRudder, kHinge };
std::array<const char*, kAircraftParts> partNames();
Scene aircraftMesh(AircraftPart part);
// Planes that separate parts that nearly touch, in the space of the first part; indices are those of
// AircraftPart.
std::vector<MovingPlane> aircraftPlanes();
// Position of the hinge's axis in the aircraft's space.
Vec3d hingePoint();

}  // namespace sightline::scenes::canyon
