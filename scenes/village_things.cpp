// Gardens, fences, and the things that stand about.

#include <array>
#include <cmath>
#include <string>

#include "scenes/nature.h"
#include "scenes/village_parts.h"

namespace sightline::scenes::village {
namespace {

// Posts at both ends and two rails, along the ground.
void addFencePanel(MeshBuilder& mesh, const HeightField& ground, Point2 a, Point2 b,
                   const std::string& name) {
  const Vec3d foot = ground.point(a), end = ground.point(b), along = end - foot;
  const double reach = length(along);
  const Vec3d x = along / reach, y = normalized(Vec3d(-along.y, along.x, 0.0));
  mesh.startObject(name, MaterialId{kWood});
  mesh.place({foot, x, y, cross(x, y)});
  for (const double height : {0.35, 0.8}) {
    mesh.box({0.02, -0.03, height}, {reach - 0.02, 0.03, height + 0.12});
  }
  for (double at = 0.25; at < reach - 0.2; at += 0.4) {
    mesh.box({at, 0.03, 0.1}, {at + 0.14, 0.06, 1.05});
  }
  mesh.place({foot, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  mesh.box({-0.06, -0.06, -0.4}, {0.06, 0.06, 1.15});
}

void addFence(MeshBuilder& mesh, const HeightField& ground, FreeGround& free, Point2 from, Point2 to,
              const std::string& name) {
  const auto panels = static_cast<int>(length(to - from) / 2.4) + 1;
  for (int i = 0; i < panels; ++i) {
    const Point2 a = from + (to - from) * (static_cast<double>(i) / panels);
    const Point2 b = from + (to - from) * ((i + 1.0) / panels);
    if (free.isFree(a, 0.15) && free.isFree(b, 0.15) && free.isFree((a + b) * 0.5, 0.3)) {
      addFencePanel(mesh, ground, a, b, name + " " + std::to_string(i));
    }
  }
}

void addWheel(MeshBuilder& mesh, const Placement& cart, double x, double y) {
  const Placement hub = cart.moved({x, y, 0.55});
  mesh.place({hub.origin, hub.x, hub.z * -1.0, hub.y});
  mesh.lathe(
      std::array<Point2, 6>{
          {{0, -0.08}, {0.1, -0.08}, {0.12, -0.04}, {0.55, -0.04}, {0.55, 0.04}, {0, 0.06}}},
      12);
}

void addCart(MeshBuilder& mesh, const Placement& at, const std::string& name) {
  mesh.startObject(name, MaterialId{kWood});
  mesh.place(at);
  mesh.box({-1.2, -0.6, 0.6}, {1.2, 0.6, 0.68});
  for (const double y : {-0.64, 0.58}) {
    mesh.box({-1.2, y, 0.6}, {1.2, y + 0.06, 1.1});
  }
  mesh.box({-1.26, -0.6, 0.68}, {-1.2, 0.6, 1.05});
  for (const double y : {-0.45, 0.4}) {
    mesh.box({1.2, y, 0.55}, {2.6, y + 0.07, 0.63});
  }
  mesh.startObject(name + " wheels", MaterialId{kIron});
  addWheel(mesh, at, -0.2, -0.8);
  addWheel(mesh, at, -0.2, 0.8);
}

void addWoodpile(MeshBuilder& mesh, const Placement& at, const std::string& name) {
  mesh.startObject(name, MaterialId{kBark});
  for (int row = 0; row < 4; ++row) {
    for (int i = 0; i < 6 - row; ++i) {
      const Placement log = at.moved({0.31 * (i + 0.5 * row) - 0.8, -0.6, 0.14 + 0.26 * row});
      mesh.place({log.origin, log.x, log.z * -1.0, log.y});
      mesh.lathe(std::array<Point2, 4>{{{0, 0}, {0.15, 0}, {0.15, 1.2}, {0, 1.2}}}, 6);
    }
  }
}

void addWell(MeshBuilder& mesh, const Placement& at, const std::string& name) {
  mesh.place(at);
  mesh.startObject(name, MaterialId{kStone});
  mesh.lathe(std::array<Point2, 5>{{{0, -0.6}, {0.9, -0.6}, {0.9, 0.8}, {0.65, 0.8}, {0, 0.1}}}, 12);
  mesh.startObject(name + " frame", MaterialId{kWood});
  for (const double x : {-0.85, 0.73}) {
    mesh.box({x, -0.06, 0.5}, {x + 0.12, 0.06, 2.2});
  }
  mesh.ridgeRoof({{-1.2, -0.8}, {1.2, 0.8}}, 2.2, 0.6, 0.0);
}

void addLamp(MeshBuilder& mesh, const Placement& at, const std::string& name) {
  mesh.place(at);
  mesh.startObject(name, MaterialId{kIron});
  mesh.lathe(std::array<Point2, 5>{{{0, -0.4}, {0.12, -0.4}, {0.06, 0.7}, {0.05, 2.9}, {0, 2.9}}}, 6);
  mesh.startObject(name + " light", MaterialId{kLight});
  mesh.lathe(std::array<Point2, 4>{{{0, 2.92}, {0.12, 2.95}, {0.2, 3.3}, {0, 3.45}}}, 6);
}

double radiusOf(Prop prop) {
  static constexpr double kRadii[] = {1.6, 0.45, 0.6, 1.3, 1.2, 0.9, 1.3, 0.3};
  return kRadii[static_cast<std::size_t>(prop)];
}

}  // namespace

void addProp(MeshBuilder& mesh, const HeightField& ground, FreeGround& free, Prop prop, Point2 place,
             Random& random, const std::string& name) {
  if (!free.tryCircle(place, radiusOf(prop))) {
    return;
  }
  const double foot = ground.lowest(place, 0.4 * radiusOf(prop));
  const Placement at = Placement{{place.x, place.y, foot}}.turned(random.uniform());
  mesh.place(at);
  switch (prop) {
    case Prop::kCart:
      return addCart(mesh, at, name + " cart");
    case Prop::kBarrel:
      mesh.startObject(name + " barrel", MaterialId{kWood});
      return mesh.lathe(std::array<Point2, 5>{{{0, -0.1}, {0.28, -0.1}, {0.36, 0.4}, {0.28, 0.9}, {0, 0.9}}},
                        12);
    case Prop::kCrate:
      mesh.startObject(name + " crate", MaterialId{kTimber});
      return mesh.box({-0.35, -0.4, -0.1}, {0.35, 0.4, 0.7});
    case Prop::kHaystack:
      mesh.startObject(name + " haystack", MaterialId{kHay});
      return addBlob(mesh, {0, 0, 0.5}, {1.1, 1.1, 1.4}, 0.25, 2, random.next());
    case Prop::kWoodpile:
      return addWoodpile(mesh, at, name + " woodpile");
    case Prop::kBench:
      mesh.startObject(name + " bench", MaterialId{kWood});
      mesh.box({-0.8, -0.2, 0.42}, {0.8, 0.2, 0.48});
      mesh.box({-0.7, -0.18, -0.2}, {-0.6, 0.18, 0.42});
      return mesh.box({0.6, -0.18, -0.2}, {0.7, 0.18, 0.42});
    case Prop::kWell:
      return addWell(mesh, at, name + " well");
    case Prop::kLamp:
      return addLamp(mesh, at, name + " lamp");
    case Prop::kCount:
      return;
  }
}

void addGarden(MeshBuilder& mesh, const HeightField& ground, FreeGround& free, const HousePlace& place,
               Random& random, const std::string& name) {
  const Footprint& house = place.footprint;
  const double depth = random.range(7.0, 12.0), back = 1.0 + depth / house.half_width, side = 0.96;
  const Point2 corners[] = {house.at(-side, 1.2), house.at(-side, back), house.at(side, back),
                            house.at(side, 1.2)};
  for (int i = 0; i < 3; ++i) {
    addFence(mesh, ground, free, corners[i], corners[i + 1], name + " fence " + std::to_string(i));
  }
  const TreeSurfaces surfaces{MaterialId{kBark}, MaterialId{kNeedles}, MaterialId{kCrown},
                              MaterialId{kLeaves}};
  const auto inside = [&] {
    const double x = random.range(-0.8, 0.8);
    return house.at(x, random.range(1.25, 0.9 * back));
  };
  for (int i = 0; i < 2; ++i) {
    const Point2 at = inside();
    if (random.chance(0.7) && free.tryCircle(at, 1.2)) {
      const TreeKind kind = random.chance(0.6) ? TreeKind::kBroadleaf : TreeKind::kLeafy;
      const double height = random.range(4.0, 7.5);
      addTree(mesh, {ground.point(at)}, kind, height, surfaces, random, name + " tree " + std::to_string(i));
    }
  }
  for (int i = 0; i < 5; ++i) {
    const auto prop = static_cast<Prop>(random.below(static_cast<std::uint32_t>(Prop::kCount)));
    addProp(mesh, ground, free, prop, inside(), random, name + " garden " + std::to_string(i));
  }
  for (int i = 0; i < 3; ++i) {
    static constexpr Prop kAtWalls[] = {Prop::kBarrel, Prop::kBench, Prop::kCrate, Prop::kLamp};
    const Prop prop = kAtWalls[random.below(4)];
    const Point2 at = house.at(random.range(-0.9, 0.9), -1.0 - (0.6 + radiusOf(prop)) / house.half_width);
    addProp(mesh, ground, free, prop, at, random, name + " front " + std::to_string(i));
  }
}

}  // namespace sightline::scenes::village
