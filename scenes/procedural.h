#pragma once

// Seeded procedural scenes, shared by the tool (demo:NAME?key=value&...), tests, benchmarks and examples. The
// same options give the same bits everywhere. Each scene has camera paths in Scene::paths.

#include <cstdint>
#include <string_view>

#include "sightline/base/result.h"
#include "sightline/scene/scene.h"

namespace sightline {

struct CityOptions {
  std::uint32_t copies = 30;  // about 10,000 polygons each
  std::uint32_t seed = 1;
};
// Streets and blocks, buildings with detailed facades, trees, street furniture.
// Camera paths: "smooth" (400 frames through the streets; the default, first), "best", "average", "worst" (by
// occlusion).
Scene makeCity(const CityOptions& options);

struct BuildingOptions {
  std::uint32_t floors = 4;
  std::uint32_t plants = 0;  // detail objects of about 644 triangles spread over the rooms
  std::uint32_t seed = 1;
  // All doors are shut, without a gap; otherwise some are, some are ajar, and below each is a gap.
  bool shut_doors = false;
};
// Corridors, rooms, doors, windows, stairs, furniture.
// Camera path: "smooth" (400 frames through corridors, rooms, stairs).
Scene makeBuilding(const BuildingOptions& options);

struct BoxCityOptions {
  std::uint32_t buildings = 10000;
  std::uint32_t boxes = 50000;  // number of small boxes
  std::uint32_t seed = 1;
  bool walled = false;  // walls of 70 m around every 4 x 4 blocks: what is seen does not grow with the city
};
// Streets between blocks of buildings, each a closed box of 8 to 60 m height, and small boxes with sides of
// 0.3 to 3 m on streets, on pavements and in courtyards, which may overlap each other. Objects: the ground,
// then the buildings, then the small boxes, then the walls.
// Camera paths: "smooth" (400 frames through the streets), "views" (20 places all over the city, looking
// along streets in all four directions).
Scene makeBoxCity(const BoxCityOptions& options);

struct ShipOptions {
  std::uint32_t decks = 6;  // decks with rooms, at least 3: two in the hull, the others above the main deck
  std::uint32_t rooms = 7;  // rooms on each side of a deck's corridor, at least 4
  std::uint32_t machinery = 60;  // machines around the main engine; limited by the number of places
  std::uint32_t seed = 1;
};
// A tanker of 180 m: hull with double bottom and bulkheads, holds with tanks, pipes on deck, decks with a
// corridor between furnished rooms, stairs, engine room. Every object is a closed solid; walls and slabs are
// boxes.
// Camera paths: "walk" (400 frames: corridor, rooms, down the stairs to the engine room; the default, first),
// "random" (200 places in rooms, in corridors and on deck, looking in any direction).
Scene makeShip(const ShipOptions& options);

// "demo:city?copies=30&seed=1", "demo:building?floors=4&plants=100",
// "demo:boxes?buildings=10000&boxes=50000", "demo:ship?decks=6&rooms=7&machinery=60",
// "demo:glass?panes=18&bottles=12" (scenes/glass.h), "demo:terrain?triangles=100000",
// "demo:cave?halls=24&triangles=100000", "demo:village?houses=160", "demo:jungle?buttes=45&trees=1500",
// "demo:voxels?halls=24" (scenes/landscapes.h), "demo:boilerhouse?boilers=5&pipes=900"
// (scenes/boiler_house.h), and frame 0 of the scenes with moving parts (scenes/moving_scene.h):
// "demo:toothpicks?n=200&scaling=ud", "demo:canyon?grid=14". An unknown scene or key, or a value out of
// range, is an error that lists the valid ones.
bool isDemoUrl(std::string_view url);
Result<Scene> makeDemoScene(std::string_view url);

}  // namespace sightline
