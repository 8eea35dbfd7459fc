// The village: its ground, its walk, and the assembly of the scene.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "scenes/landscapes.h"
#include "scenes/nature.h"
#include "scenes/noise.h"
#include "scenes/village_parts.h"
#include "scenes/walk.h"

namespace sightline {
namespace scenes::village {
namespace {

constexpr double kHalfSize = 200.0;  // of the ground, metres
constexpr double kSquare = 15.0;     // radius of the market square, metres
constexpr std::uint32_t kQuads = 130, kGroundTiles = 12;
constexpr std::uint32_t kFieldTrees = 260;

std::vector<Material> materials() {
  constexpr Opacity kOpaque = Opacity::kOpaque;
  return {{"grass", kOpaque, false, {0.17f, 0.27f, 0.08f, 1.0f}},
          {"earth", kOpaque, false, {0.31f, 0.25f, 0.17f, 1.0f}},
          {"plaster", kOpaque, false, {0.70f, 0.66f, 0.57f, 1.0f}},
          {"ochre", kOpaque, false, {0.61f, 0.41f, 0.18f, 1.0f}},
          {"timber", kOpaque, false, {0.36f, 0.23f, 0.12f, 1.0f}},
          {"brick", kOpaque, false, {0.40f, 0.17f, 0.11f, 1.0f}},
          {"tiles", kOpaque, false, {0.42f, 0.13f, 0.07f, 1.0f}},
          {"thatch", kOpaque, false, {0.45f, 0.36f, 0.17f, 1.0f}},
          {"slate", kOpaque, false, {0.15f, 0.17f, 0.20f, 1.0f}},
          {"stone", kOpaque, false, {0.45f, 0.43f, 0.40f, 1.0f}},
          {"wood", kOpaque, false, {0.27f, 0.16f, 0.08f, 1.0f}},
          {"window", kOpaque, false, {0.09f, 0.14f, 0.20f, 1.0f}},
          {"iron", kOpaque, false, {0.10f, 0.10f, 0.11f, 1.0f}},
          {"light", kOpaque, false, {0.90f, 0.75f, 0.35f, 1.0f}},
          {"hay", kOpaque, false, {0.58f, 0.47f, 0.19f, 1.0f}},
          {"bark", kOpaque, false, {0.17f, 0.11f, 0.07f, 1.0f}},
          {"needles", kOpaque, false, {0.05f, 0.15f, 0.06f, 1.0f}},
          {"crown", kOpaque, false, {0.12f, 0.28f, 0.07f, 1.0f}},
          {"leaves", Opacity::kAlphaTested, true, {0.22f, 0.34f, 0.09f, 1.0f}}};
}

HeightField hill(std::uint64_t seed) {
  return {{{-kHalfSize, -kHalfSize}, {kHalfSize, kHalfSize}}, kQuads, [&](Point2 p) {
            const double rim = smoothStep(0.78, 1.0, std::max(std::abs(p.x), std::abs(p.y)) / kHalfSize);
            return 14.0 * rim + 9.0 * noise(p / 120.0, 3 * seed) + 4.0 * noise(p / 60.0, 3 * seed + 1) +
                   0.5 * noise(p / 18.0, 3 * seed + 2);
          }};
}

double fromStreets(Point2 p) {
  double nearest = 1e30;
  for (const std::vector<Vec3d>& street : streets()) {
    nearest = std::min(nearest, distanceToLine(p, street));
  }
  return nearest;
}

// Things on the edge of the square and of the streets, and trees around the village.
void addSurroundings(MeshBuilder& mesh, const HeightField& ground, FreeGround& free, Random& random) {
  addProp(mesh, ground, free, Prop::kWell, {5.0, -9.0}, random, "market");
  for (std::uint32_t i = 0; i < 60; ++i) {
    const Point2 direction = unitVector(random.uniform());
    const Point2 at = direction * random.range(5.0, kSquare);
    const auto prop = static_cast<Prop>(random.below(static_cast<std::uint32_t>(Prop::kCount)));
    addProp(mesh, ground, free, prop, at, random, "market " + std::to_string(i));
  }
  const TreeSurfaces surfaces{MaterialId{kBark}, MaterialId{kNeedles}, MaterialId{kCrown},
                              MaterialId{kLeaves}};
  std::uint32_t tree = 0;
  for (std::uint32_t attempt = 0; attempt < 20 * kFieldTrees && tree < kFieldTrees; ++attempt) {
    const double x = random.range(-kHalfSize, kHalfSize), y = random.range(-kHalfSize, kHalfSize);
    const Point2 at{x, y};
    const double height = random.range(6.0, 12.0), any = random.uniform();
    const TreeKind kind = any < 0.3   ? TreeKind::kConifer
                          : any < 0.8 ? TreeKind::kBroadleaf
                                      : TreeKind::kLeafy;
    if (fromStreets(at) > 16.0 && free.tryCircle(at, 0.8 * crownRadius(kind, height))) {
      addTree(mesh, {ground.point(at)}, kind, height, surfaces, random, "tree " + std::to_string(tree++));
    }
  }
}

CameraPath walk(const HeightField& ground) {
  const std::vector<Vec3d> corners{{-138, -28, 0}, {-75, -45, 0}, {0, 0, 0},   {25, 80, 0},
                                   {-40, 50, 0},   {-98, 55, 0},  {-84, -5, 0}};
  const WalkOptions options{.name = "streets",
                            .look_ahead = 5.0,
                            .glance = 0.35,
                            .glance_turns = 8,
                            .calm = 3,
                            .max_turn = 0.03,
                            .far = 900.0};
  return walkAlong(overGround(ground, roundedRoute(corners, 12.0), 1.7), options);
}

void addAll(MeshBuilder& mesh, const HeightField& ground, const VillageOptions& options) {
  ground.addTiles(mesh, kGroundTiles, "ground",
                  [](Point2 p) { return MaterialId{fromStreets(p) < 9.0 ? kEarth : kGrass}; });
  FreeGround free;
  for (const std::vector<Vec3d>& street : streets()) {
    free.keepLine(street, kStreetHalf - 0.4);
  }
  FreeGround plots = free;
  plots.takeCircle({0.0, 0.0}, kSquare);
  Random church(options.seed, 1), houses(options.seed, 2);
  addChurch(mesh, ground, plots, church);
  const std::vector<HousePlace> places = planHouses(plots, options.houses, houses);
  Footprint nave{{-22.0, 27.0}, unitVector(0.06), 16.5, 6.0};
  free.takeFootprint(nave);
  for (const HousePlace& place : places) {
    Footprint taken = place.footprint;
    taken.half_length += 0.15;
    taken.half_width += 0.15;
    free.takeFootprint(taken);
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    Random random(options.seed, 100 + i);
    const std::string name = "house " + std::to_string(i);
    addHouse(mesh, ground, places[i], random, name);
    addGarden(mesh, ground, free, places[i], random, name);
  }
  Random around(options.seed, 3);
  addSurroundings(mesh, ground, free, around);
}

}  // namespace
}  // namespace scenes::village

Scene makeVillage(const VillageOptions& options) {
  using namespace scenes;
  Scene scene;
  scene.materials = village::materials();
  const HeightField ground = village::hill(options.seed);
  {
    MeshBuilder mesh(scene);
    village::addAll(mesh, ground, options);
  }
  weldPositions(scene);
  updateBounds(scene);
  scene.paths = {village::walk(ground)};
  return scene;
}

}  // namespace sightline
