#pragma once

// The pieces of the canyon: where the valley runs, its terrain, and the aircraft that fly in it. Plan space.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "scenes/mesh_builder.h"
#include "scenes/moving_scene.h"
#include "scenes/placement.h"

namespace sightline::scenes::canyon {

inline constexpr double kSize = 720.0;  // side of the terrain, which lies round the origin; metres

enum Class : std::uint32_t { kAircraft, kTerrain, kSky };

// The valley's middle line at an easting, as y = middle(x).
struct ValleyPoint {
  double middle = 0.0, slope = 0.0, bend = 0.0;  // the function and its first two derivatives
};
ValleyPoint valleyAt(double x);

// About 2,473 triangles, without the corners of the square. World space.
Scene terrainMesh(std::uint32_t seed);

// Its six parts, in their own spaces; those of body, wing, engine and tail are the aircraft's: it looks along
// x, y is up. Hinge and rudder turn about their own y axis.
inline constexpr std::uint32_t kAircraftParts = 6;
enum AircraftPart : std::uint32_t { kBody, kWing, kEngine, kTail, kRudder, kHinge };
std::array<const char*, kAircraftParts> partNames();
Scene aircraftMesh(AircraftPart part);
// Planes between those that nearly touch, in the space of the first; numbers are those of AircraftPart.
std::vector<MovingPlane> aircraftPlanes();
// Where the hinge's axis is in the aircraft's space.
Vec3d hingePoint();

}  // namespace sightline::scenes::canyon
