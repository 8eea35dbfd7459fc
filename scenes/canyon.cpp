// Aircraft in a valley: their flight, and the assembly of the scene.
//
// Based on: John Snyder, Jed Lengyel. Visibility Sorting and Compositing for Image-Based Rendering.
// Microsoft Research MSR-TR-97-11, 1997, section 12.2.
// Differs from the paper in: the shapes, which the paper shows in a single picture. Numbers of polygons are
// about the same.

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "scenes/canyon_parts.h"
#include "scenes/moving_parts.h"
#include "scenes/random.h"
#include "scenes/split_scene.h"
#include "sightline/layers/pre_split.h"

namespace sightline {
namespace scenes::canyon {
namespace {

constexpr std::uint32_t kAircraftCount = 6;
constexpr double kHullGrowth = 0.005;
constexpr double kFirstX = -190.0, kLastX = 290.0;  // x of the leader
constexpr double kHeight = 34.0;                    // metres above the valley's floor
constexpr double kSkyRadius = 2000.0;

struct Flight {
  std::uint32_t frames = 250;
  std::array<double, kAircraftCount> phases{};  // phase of swaying, in turns

  double leaderX(double frame) const { return kFirstX + (kLastX - kFirstX) * frame / (frames - 1); }
  Mat4 worldFromAircraft(std::uint32_t i, double frame) const;
  Mat4 aircraftFromHinge(std::uint32_t i, double frame) const;
};

// The point `across` metres to the left of the valley's centre line.
Vec3d besideMiddle(double x, double across, double height) {
  const ValleyPoint valley = valleyAt(x);
  const double stretch = std::sqrt(1.0 + valley.slope * valley.slope);
  return {x - across * valley.slope / stretch, valley.middle + across / stretch, height};
}

// Two columns of three aircraft, the right one slightly behind.
Mat4 Flight::worldFromAircraft(std::uint32_t i, double frame) const {
  const std::uint32_t row = i / 2;
  const double behind = 22.0 * row + (i % 2 == 0 ? 0.0 : 8.0), aside = i % 2 == 0 ? 11.0 : -11.0;
  const double sway = unitVector(frame / 170.0 + phases[i]).y, bob = unitVector(frame / 120.0 + phases[i]).x;
  const double x = leaderX(frame) - behind;
  const Vec3d at = besideMiddle(x, aside + sway, kHeight + 1.5 * bob);
  const ValleyPoint valley = valleyAt(x);
  const Vec3d forward = normalized(Vec3d(1.0, valley.slope, 0.0));
  const double stretch = 1.0 + valley.slope * valley.slope;
  // The aircraft banks in curves.
  const double lean = 60.0 * valley.bend / (stretch * std::sqrt(stretch));
  const Vec3d left(-forward.y, forward.x, 0.0), up = normalized(Vec3d(0, 0, 1) + left * lean);
  return rigid(worldFromPlan(forward), worldFromPlan(up), worldFromPlan(cross(forward, up)),
               worldFromPlan(at));
}

Mat4 Flight::aircraftFromHinge(std::uint32_t i, double frame) const {
  const Point2 d = unitVector(0.03 * unitVector(frame / 40.0 + phases[i]).y);
  return rigid({d.x, 0, -d.y}, {0, 1, 0}, {d.y, 0, d.x}, hingePoint());
}

bool turnsWithHinge(std::uint32_t part) {
  return part == kRudder || part == kHinge;
}

void addAircraft(MovingScene& scene, const Flight& flight) {
  for (std::uint32_t p = 0; p < kAircraftParts; ++p) {
    scene.hulls.push_back(hullOf(aircraftMesh(static_cast<AircraftPart>(p)), kHullGrowth));
  }
  for (std::uint32_t i = 0; i < kAircraftCount; ++i) {
    const auto first_part = static_cast<std::uint32_t>(scene.parts.size());
    const Mat4 world_from_aircraft = flight.worldFromAircraft(i, 0.0);
    for (std::uint32_t p = 0; p < kAircraftParts; ++p) {
      MovingPart part;
      part.name = std::string(partNames()[p]) + " " + std::to_string(i);
      part.hulls = {p};
      part.class_of = kAircraft;
      addMovingPart(
          scene, std::move(part), aircraftMesh(static_cast<AircraftPart>(p)),
          turnsWithHinge(p) ? world_from_aircraft * flight.aircraftFromHinge(i, 0.0) : world_from_aircraft,
          MaterialId{kAircraft});
    }
    for (MovingPlane plane : aircraftPlanes()) {
      plane.first += first_part;
      plane.second += first_part;
      scene.planes.push_back(plane);
    }
  }
}

SplitMesh splitTerrain(const CanyonOptions& options) {
  const Scene terrain = terrainMesh(options.seed);
  std::vector<Vec3d> positions;
  for (const Vec3f& position : terrain.positions) {
    positions.emplace_back(position);
  }
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (std::size_t i = 0; i < terrain.indices.size(); i += 3) {
    triangles.push_back({terrain.indices[i], terrain.indices[i + 1], terrain.indices[i + 2]});
  }
  const SplitAxis axes[] = {{{1, 0, 0}, -0.5 * kSize, 0.5 * kSize, options.grid},
                            {{0, 0, 1}, -0.5 * kSize, 0.5 * kSize, options.grid}};
  return splitMesh(positions, triangles, gridCells(axes), options.inflation);
}

void addTerrain(MovingScene& scene, const CanyonOptions& options) {
  const SplitMesh split = splitTerrain(options);
  constexpr std::uint32_t kNone = 0xffffffffu;
  std::vector<std::uint32_t> part_of;
  for (const SplitPiece& piece : split.pieces) {
    const Scene mesh = pieceMesh(piece);
    part_of.push_back(mesh.indices.empty() ? kNone : static_cast<std::uint32_t>(scene.parts.size()));
    if (mesh.indices.empty()) {
      continue;
    }
    MovingPart part;
    part.name = "terrain " + std::to_string(piece.cell);
    part.hulls = {static_cast<std::uint32_t>(scene.hulls.size())};
    part.class_of = kTerrain;
    part.settings.is_static = true;
    scene.hulls.push_back(hullOf(mesh));
    addMovingPart(scene, std::move(part), mesh, Mat4{}, MaterialId{kTerrain});
  }
  for (const SplitNeighbours& neighbours : split.neighbours) {
    if (part_of[neighbours.first] != kNone && part_of[neighbours.second] != kNone) {
      scene.planes.push_back({part_of[neighbours.first], part_of[neighbours.second], neighbours.rule});
    }
  }
}

// A sky of 480 triangles, seen from inside.
void addSky(MovingScene& scene) {
  std::vector<Point2> profile{{0.0, -kSkyRadius}};
  for (int i = 1; i < 13; ++i) {
    const Point2 d = unitVector(0.5 * i / 13.0);
    profile.push_back({kSkyRadius * d.y, -kSkyRadius * d.x});
  }
  profile.push_back({0.0, kSkyRadius});
  const Scene mesh = buildPartMesh([&](MeshBuilder& builder) { builder.lathe(profile, 20); });
  MovingPart part;
  part.name = "sky";
  part.hulls = {static_cast<std::uint32_t>(scene.hulls.size())};
  part.class_of = kSky;
  part.settings = {.place = PartSettings::Place::kBackdrop, .is_static = true};
  scene.hulls.push_back(hullOf(mesh));
  addMovingPart(scene, std::move(part), mesh, Mat4{}, MaterialId{kSky});
}

// The camera flies behind the formation, slightly above it.
CameraPath cameraPath(const Flight& flight) {
  CameraPath path;
  path.name = "chase";
  path.z_far = 4500.0;
  for (std::uint32_t f = 0; f < flight.frames; ++f) {
    const double x = flight.leaderX(f);
    const Vec3d eye = besideMiddle(x - 95.0, 5.0, kHeight + 7.0),
                target = besideMiddle(x - 20.0, 0.0, kHeight);
    path.frames.push_back({worldFromPlan(eye), worldFromPlan(normalized(target - eye)), {0.0, 1.0, 0.0}});
  }
  return path;
}

std::vector<Material> materials() {
  return {{.name = "aircraft", .base_color = {0.75f, 0.76f, 0.8f, 1.0f}},
          {.name = "terrain", .base_color = {0.55f, 0.4f, 0.28f, 1.0f}},
          {.name = "sky", .double_sided = true, .base_color = {0.45f, 0.62f, 0.85f, 1.0f}}};
}

}  // namespace
}  // namespace scenes::canyon

MovingScene makeCanyon(const CanyonOptions& options) {
  using namespace scenes;
  using namespace scenes::canyon;
  MovingScene scene;
  scene.classes = {"aircraft", "terrain", "sky"};
  scene.scene.materials = materials();
  auto flight = std::make_shared<Flight>();
  flight->frames = scene.frames;
  Random random(options.seed, 2);
  for (double& phase : flight->phases) {
    phase = random.uniform();
  }
  addAircraft(scene, *flight);
  addTerrain(scene, options);
  addSky(scene);
  scene.pose = [flight](std::uint32_t frame, std::span<Mat4> world_from_part) {
    std::fill(world_from_part.begin(), world_from_part.end(), Mat4{});
    for (std::uint32_t i = 0; i < kAircraftCount; ++i) {
      const Mat4 world_from_aircraft = flight->worldFromAircraft(i, frame);
      const Mat4 world_from_hinge = world_from_aircraft * flight->aircraftFromHinge(i, frame);
      for (std::uint32_t p = 0; p < kAircraftParts; ++p) {
        world_from_part[i * kAircraftParts + p] = turnsWithHinge(p) ? world_from_hinge : world_from_aircraft;
      }
    }
  };
  weldPositions(scene.scene);
  scene.scene.paths = {cameraPath(*flight)};
  return scene;
}

std::size_t canyonTerrainTriangles(const CanyonOptions& options) {
  std::size_t count = 0;
  for (const SplitPiece& piece : scenes::canyon::splitTerrain(options).pieces) {
    count += pieceMesh(piece).indices.size() / 3;
  }
  return count;
}

}  // namespace sightline
