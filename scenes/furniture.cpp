#include "scenes/furniture.h"

#include <array>
#include <initializer_list>

#include "scenes/building_parts.h"

namespace sightline::scenes {
namespace {

struct BoxShape {
  Vec3d low, high;
};

void addBoxes(MeshBuilder& mesh, std::initializer_list<BoxShape> boxes) {
  for (const BoxShape& box : boxes) {
    mesh.box(box.low, box.high);
  }
}

void addDesk(MeshBuilder& mesh, const std::string& name) {
  mesh.startObject(name, id(BuildingMaterial::kWood));
  addBoxes(mesh, {{{-0.6, 0.02, 0.72}, {0.6, 0.7, 0.75}},
                  {{-0.58, 0.05, 0.0}, {-0.55, 0.68, 0.72}},
                  {{0.2, 0.05, 0.0}, {0.58, 0.65, 0.72}},
                  {{-0.55, 0.05, 0.3}, {0.2, 0.07, 0.72}}});
  mesh.box({0.22, 0.65, 0.06}, {0.56, 0.67, 0.69}, kAllFaces & ~kSouth);
  mesh.startObject(name + " screen", id(BuildingMaterial::kScreen));
  addBoxes(mesh, {{{-0.3, 0.2, 0.85}, {0.25, 0.23, 1.18}},
                  {{-0.08, 0.15, 0.75}, {0.03, 0.2, 1.0}},
                  {{-0.25, 0.45, 0.75}, {0.2, 0.6, 0.77}}});
}

void addChairBoxes(MeshBuilder& mesh, double x, double y, bool back_to_wall) {
  const double back = back_to_wall ? y - 0.2 : y + 0.17;
  addBoxes(mesh, {{{x - 0.2, y - 0.2, 0.42}, {x + 0.2, y + 0.2, 0.46}},
                  {{x - 0.2, back, 0.5}, {x + 0.2, back + 0.03, 0.9}}});
  for (const double dx : {-0.19, 0.16}) {
    mesh.box({x + dx, y - 0.19, 0.0}, {x + dx + 0.03, y + 0.19, 0.42}, kSides);
  }
}

void addShelf(MeshBuilder& mesh, Random& random, const std::string& name) {
  mesh.startObject(name, id(BuildingMaterial::kDarkWood));
  addBoxes(mesh, {{{-0.6, 0.02, 0.0}, {-0.57, 0.34, 2.0}},
                  {{0.57, 0.02, 0.0}, {0.6, 0.34, 2.0}},
                  {{-0.57, 0.02, 0.0}, {0.57, 0.04, 2.0}}});
  for (std::uint32_t i = 0; i < 5; ++i) {
    mesh.box({-0.57, 0.04, 0.05 + 0.38 * i}, {0.57, 0.34, 0.08 + 0.38 * i}, kAllFaces & ~(kWest | kEast));
  }
  mesh.startObject(name + " books", id(BuildingMaterial::kBooks));
  for (std::uint32_t i = 0; i < 5; ++i) {
    const double west = random.range(-0.55, 0.0), width = random.range(0.2, 0.55), z = 0.08 + 0.38 * i;
    mesh.box({west, 0.06, z}, {west + width, random.range(0.22, 0.3), z + random.range(0.2, 0.32)},
             kNoBottom & ~kSouth);
  }
}

void addCupboard(MeshBuilder& mesh, const std::string& name) {
  mesh.startObject(name, id(BuildingMaterial::kWhite));
  addBoxes(mesh, {{{-0.6, 0.02, 0.0}, {0.6, 0.58, 2.1}},
                  {{-0.59, 0.58, 0.06}, {-0.01, 0.6, 2.08}},
                  {{0.01, 0.58, 0.06}, {0.59, 0.6, 2.08}}});
}

void addBed(MeshBuilder& mesh, const std::string& name) {
  mesh.startObject(name, id(BuildingMaterial::kWood));
  addBoxes(mesh, {{{-1.0, 0.02, 0.15}, {1.0, 0.9, 0.32}},
                  {{-1.0, 0.02, 0.32}, {-0.96, 0.9, 0.9}},
                  {{-0.98, 0.04, 0.0}, {-0.9, 0.88, 0.15}},
                  {{0.9, 0.04, 0.0}, {0.98, 0.88, 0.15}}});
  mesh.startObject(name + " bedding", id(BuildingMaterial::kWhite));
  addBoxes(mesh, {{{-0.94, 0.05, 0.32}, {0.97, 0.87, 0.5}}, {{-0.9, 0.15, 0.5}, {-0.5, 0.77, 0.6}}});
}

void addSofa(MeshBuilder& mesh, const std::string& name) {
  mesh.startObject(name, id(BuildingMaterial::kFabric));
  addBoxes(mesh, {{{-1.0, 0.02, 0.08}, {1.0, 0.85, 0.4}},
                  {{-1.0, 0.02, 0.4}, {1.0, 0.25, 0.85}},
                  {{-1.0, 0.25, 0.4}, {-0.8, 0.85, 0.62}},
                  {{0.8, 0.25, 0.4}, {1.0, 0.85, 0.62}},
                  {{-0.78, 0.27, 0.4}, {-0.01, 0.83, 0.5}},
                  {{0.01, 0.27, 0.4}, {0.78, 0.83, 0.5}}});
}

void addBasin(MeshBuilder& mesh, const Placement& at, const std::string& name) {
  mesh.startObject(name + " mirror", id(BuildingMaterial::kMetal));
  mesh.box({-0.3, 0.005, 1.2}, {0.3, 0.02, 1.9});
  mesh.place(at.moved({0, 0.28, 0}));
  mesh.startObject(name, id(BuildingMaterial::kCeramic));
  mesh.lathe(
      std::array<Point2, 7>{
          {{0, 0}, {0.1, 0}, {0.08, 0.65}, {0.26, 0.8}, {0.26, 0.86}, {0.22, 0.86}, {0, 0.74}}},
      8);
}

void addToilet(MeshBuilder& mesh, const Placement& at, const std::string& name) {
  mesh.startObject(name, id(BuildingMaterial::kCeramic));
  mesh.box({-0.2, 0.02, 0.4}, {0.2, 0.2, 0.85});
  mesh.place(at.moved({0, 0.42, 0}));
  mesh.lathe(std::array<Point2, 6>{{{0, 0}, {0.14, 0}, {0.11, 0.2}, {0.21, 0.42}, {0.17, 0.42}, {0, 0.25}}},
             8);
}

void addRadiator(MeshBuilder& mesh, const std::string& name) {
  mesh.startObject(name, id(BuildingMaterial::kWhite));
  for (std::uint32_t i = 0; i < 5; ++i) {
    mesh.box({-0.45 + 0.2 * i, 0.03, 0.12}, {-0.29 + 0.2 * i, 0.11, 0.72});
  }
  mesh.box({-0.47, 0.05, 0.15}, {0.55, 0.08, 0.2});
}

void addRack(MeshBuilder& mesh, Random& random, const std::string& name) {
  mesh.startObject(name, id(BuildingMaterial::kMetal));
  for (const double x : {-0.6, 0.56}) {
    for (const double y : {0.03, 0.5}) {
      mesh.box({x, y, 0.0}, {x + 0.04, y + 0.04, 2.2});
    }
  }
  for (std::uint32_t i = 0; i < 4; ++i) {
    mesh.box({-0.6, 0.03, 0.2 + 0.6 * i}, {0.6, 0.54, 0.23 + 0.6 * i});
  }
  mesh.startObject(name + " boxes", id(BuildingMaterial::kWood));
  for (std::uint32_t i = 0; i < 3; ++i) {
    mesh.box({-0.5, 0.08, 0.23 + 0.6 * i},
             {random.range(-0.2, -0.05), 0.5, random.range(0.5, 0.75) + 0.6 * i});
    mesh.box({0.05, 0.08, 0.23 + 0.6 * i}, {random.range(0.3, 0.5), 0.48, random.range(0.4, 0.7) + 0.6 * i});
  }
}

void addTable(MeshBuilder& mesh, const std::string& name) {
  mesh.startObject(name, id(BuildingMaterial::kDarkWood));
  addBoxes(mesh, {{{-0.9, -0.5, 0.7}, {0.9, 0.5, 0.74}},
                  {{-0.85, -0.45, 0.0}, {-0.78, -0.38, 0.7}},
                  {{0.78, -0.45, 0.0}, {0.85, -0.38, 0.7}},
                  {{-0.85, 0.38, 0.0}, {-0.78, 0.45, 0.7}},
                  {{0.78, 0.38, 0.0}, {0.85, 0.45, 0.7}}});
  for (std::uint32_t i = 0; i < 6; ++i) {
    mesh.startObject(name + " chair " + std::to_string(i), id(BuildingMaterial::kFabric));
    addChairBoxes(mesh, -0.55 + 0.55 * (i % 3), i < 3 ? -0.62 : 0.62, i < 3);
  }
}

void addFloorLamp(MeshBuilder& mesh, const Placement& at, const std::string& name) {
  mesh.place(at.moved({0, 0.25, 0}));
  mesh.startObject(name, id(BuildingMaterial::kLight));
  mesh.lathe(
      std::array<Point2, 7>{
          {{0, 0}, {0.15, 0}, {0.02, 0.05}, {0.02, 1.4}, {0.2, 1.4}, {0.12, 1.7}, {0, 1.7}}},
      6);
}

}  // namespace

void addPiece(MeshBuilder& mesh, Piece piece, const Placement& at, Random& random, const std::string& name) {
  mesh.place(at);
  switch (piece) {
    case Piece::kDesk:
      return addDesk(mesh, name + " desk");
    case Piece::kChair:
      mesh.startObject(name + " chair", id(BuildingMaterial::kFabric));
      return addChairBoxes(mesh, -0.15, 0.72, false);
    case Piece::kShelf:
      return addShelf(mesh, random, name + " shelf");
    case Piece::kCupboard:
      return addCupboard(mesh, name + " cupboard");
    case Piece::kBed:
      return addBed(mesh, name + " bed");
    case Piece::kBedside:
      mesh.startObject(name + " bedside table", id(BuildingMaterial::kWood));
      return addBoxes(mesh,
                      {{{-0.25, 0.02, 0.0}, {0.25, 0.42, 0.5}}, {{-0.22, 0.42, 0.06}, {0.22, 0.44, 0.44}}});
    case Piece::kSofa:
      return addSofa(mesh, name + " sofa");
    case Piece::kBasin:
      return addBasin(mesh, at, name + " basin");
    case Piece::kToilet:
      return addToilet(mesh, at, name + " toilet");
    case Piece::kRadiator:
      return addRadiator(mesh, name + " radiator");
    case Piece::kRack:
      return addRack(mesh, random, name + " rack");
    case Piece::kTable:
      return addTable(mesh, name + " table");
    case Piece::kFloorLamp:
      return addFloorLamp(mesh, at, name + " lamp");
    case Piece::kCeilingLight:
      mesh.startObject(name + " light", id(BuildingMaterial::kLight));
      return addBoxes(mesh, {{{-0.6, -0.12, -0.08}, {0.6, 0.12, 0.0}}});
  }
}

}  // namespace sightline::scenes
