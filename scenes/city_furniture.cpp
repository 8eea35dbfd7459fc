// The furniture of streets and squares: trees, lamps, benches, bins, hydrants, cars, traffic lights, hedges,
// kiosks.

#include <array>

#include "scenes/city_parts.h"

namespace sightline::scenes {
namespace {

void addTree(MeshBuilder& mesh, Random& random, const std::string& name) {
  const double scale = random.range(0.8, 1.15), radius = random.range(1.3, 1.9) * scale;
  const double low = 2.4, high = low + random.range(3.0, 4.2) * scale, middle = (low + high) * 0.5;
  mesh.startObject(name + " trunk", id(CityMaterial::kBark));
  mesh.lathe(std::array<Point2, 4>{{{0, 0}, {0.2 * scale, 0}, {0.12 * scale, middle}, {0, middle}}}, 5);
  mesh.startObject(name + " crown",
                   id(random.chance(0.7) ? CityMaterial::kCrown : CityMaterial::kLightCrown));
  mesh.lathe(
      std::array<Point2, 5>{
          {{0, low}, {radius * 0.8, low + 0.5}, {radius, middle}, {radius * 0.65, high - 0.6}, {0, high}}},
      6);
}

void addLamp(MeshBuilder& mesh, const std::string& name) {
  mesh.startObject(name, id(CityMaterial::kMetal));
  mesh.lathe(std::array<Point2, 5>{{{0, 0}, {0.14, 0}, {0.07, 0.9}, {0.05, 5.6}, {0, 5.6}}}, 6);
  mesh.box({-0.05, -1.3, 5.5}, {0.05, 0.0, 5.6});
  mesh.box({-0.14, -1.6, 5.38}, {0.14, -0.8, 5.5});
}

void addBench(MeshBuilder& mesh, const std::string& name) {
  mesh.startObject(name, id(CityMaterial::kWood));
  mesh.box({-0.9, -0.25, 0.42}, {0.9, 0.25, 0.48});
  mesh.box({-0.9, 0.2, 0.55}, {0.9, 0.26, 0.95});
  mesh.box({-0.75, -0.2, 0.0}, {-0.67, 0.26, 0.42}, kSides);
  mesh.box({0.67, -0.2, 0.0}, {0.75, 0.26, 0.42}, kSides);
}

void addBin(MeshBuilder& mesh, const std::string& name) {
  mesh.startObject(name, id(CityMaterial::kGreen));
  mesh.lathe(std::array<Point2, 5>{{{0, 0}, {0.2, 0}, {0.26, 0.85}, {0.22, 0.85}, {0, 0.75}}}, 8);
}

void addHydrant(MeshBuilder& mesh, const std::string& name) {
  mesh.startObject(name, id(CityMaterial::kRed));
  mesh.lathe(std::array<Point2, 6>{{{0, 0}, {0.16, 0}, {0.12, 0.1}, {0.12, 0.6}, {0.15, 0.65}, {0, 0.8}}}, 8);
  mesh.box({-0.22, -0.06, 0.42}, {0.22, 0.06, 0.54});
}

void addCar(MeshBuilder& mesh, const Placement& at, Random& random, const std::string& name) {
  static constexpr CityMaterial kPaints[] = {CityMaterial::kRed, CityMaterial::kBlue, CityMaterial::kWhite,
                                             CityMaterial::kDarkTrim};
  const double cabin = random.range(1.35, 1.6);
  // Side view, extruded across the car's width. x is along the car's length.
  const std::array<Point2, 10> profile{{{-2.1, 0.3},
                                        {2.1, 0.3},
                                        {2.15, 0.7},
                                        {1.1, 0.9},
                                        {0.5, cabin},
                                        {-1.2, cabin},
                                        {-1.8, 0.95},
                                        {-2.1, 0.9},
                                        {-2.15, 0.6},
                                        {-2.12, 0.4}}};
  const Placement side{at.point({0, 0.85, 0}), at.x, at.z, at.y * -1.0};
  mesh.place(side);
  mesh.startObject(name + " body", id(kPaints[random.below(4)]));
  mesh.prism(profile, 0.0, 1.7);
  mesh.startObject(name + " wheels and windows", id(CityMaterial::kRubber));
  for (const double x : {-1.35, 1.35}) {
    for (const double y : {-0.04, 1.54}) {
      mesh.place(side.moved({x, 0.32, y}));
      mesh.lathe(std::array<Point2, 4>{{{0, 0}, {0.32, 0}, {0.32, 0.2}, {0, 0.2}}}, 8);
    }
  }
  mesh.place(side);
  const std::array<Point2, 4> glass{
      {{-1.6, 0.97}, {0.92, 0.97}, {0.42, cabin - 0.06}, {-1.15, cabin - 0.06}}};
  mesh.prism(glass, -0.015, 1.715, kBottom | kTop);
}

void addTrafficLight(MeshBuilder& mesh, const std::string& name) {
  mesh.startObject(name, id(CityMaterial::kMetal));
  mesh.lathe(std::array<Point2, 4>{{{0, 0}, {0.08, 0}, {0.06, 3.4}, {0, 3.4}}}, 6);
  mesh.box({-0.17, -0.3, 2.5}, {0.17, -0.06, 3.4});
  mesh.startObject(name + " lamps", id(CityMaterial::kLamp));
  for (std::uint32_t i = 0; i < 3; ++i) {
    mesh.box({-0.1, -0.38, 2.6 + 0.28 * i}, {0.1, -0.3, 2.8 + 0.28 * i}, kAllFaces & ~kNorth);
  }
}

void addHedge(MeshBuilder& mesh, Random& random, const std::string& name) {
  mesh.startObject(name, id(CityMaterial::kGreen));
  mesh.box({-2.0, -0.35, 0.0}, {2.0, 0.35, random.range(0.8, 1.3)});
}

void addKiosk(MeshBuilder& mesh, const std::string& name) {
  mesh.startObject(name, id(CityMaterial::kBlue));
  mesh.plate({{-1.5, -1.2}, {1.5, 1.2}}, 0.0, 2.5, {});
  mesh.box({-1.2, -1.7, 0.9}, {1.2, -1.2, 1.0});
  mesh.startObject(name + " roof", id(CityMaterial::kWhite));
  mesh.ridgeRoof({{-1.8, -1.8}, {1.8, 1.4}}, 2.5, 0.6, 1.2);
}

}  // namespace

void addFurniture(MeshBuilder& mesh, Furniture what, const Placement& placement, Random& random,
                  const std::string& name) {
  mesh.place(placement);
  switch (what) {
    case Furniture::kTree:
      mesh.place(placement.turned(random.uniform()));
      return addTree(mesh, random, name);
    case Furniture::kLamp:
      return addLamp(mesh, name);
    case Furniture::kBench:
      return addBench(mesh, name);
    case Furniture::kBin:
      return addBin(mesh, name);
    case Furniture::kHydrant:
      return addHydrant(mesh, name);
    case Furniture::kCar:
      return addCar(mesh, placement, random, name);
    case Furniture::kTrafficLight:
      return addTrafficLight(mesh, name);
    case Furniture::kHedge:
      return addHedge(mesh, random, name);
    case Furniture::kKiosk:
      return addKiosk(mesh, name);
  }
}

}  // namespace sightline::scenes
