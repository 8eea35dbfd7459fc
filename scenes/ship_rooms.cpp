// Furniture. A room's x from 0.7 to 1.9 stays free as a passage.

#include "scenes/ship_parts.h"

namespace sightline::scenes::ship {
namespace {

// Places pieces of furniture in one room; each box is an object.
class Furnisher {
 public:
  Furnisher(MeshBuilder& mesh, const Room& room, Random random) : mesh_(mesh), room_(room), random_(random) {}

  void cabin();
  void mess();
  void store();
  void workshop();
  void ceilingLight();

 private:
  void piece(const char* name, Paint paint, const Vec3d& low, const Vec3d& high) {
    mesh_.startObject(room_.name + " " + name + " " + std::to_string(count_++), id(paint));
    mesh_.place(room_.placement);
    mesh_.box(low, high);
  }
  void turned(const char* name, Paint paint, const Vec3d& foot, std::span<const Point2> profile,
              std::uint32_t segments) {
    mesh_.startObject(room_.name + " " + name + " " + std::to_string(count_++), id(paint));
    mesh_.place(room_.placement.moved(foot));
    mesh_.lathe(profile, segments);
  }
  void bathroom();
  void bed(double y);
  void desk(double y);
  void table(double x, double y);
  void chair(double x, double y, double back_side);
  void lamp(const Vec3d& foot);
  void bottle(const Vec3d& foot);
  void shelves(double y);

  MeshBuilder& mesh_;
  const Room& room_;
  Random random_;
  std::uint32_t count_ = 0;
};

void Furnisher::ceilingLight() {
  const double top = kStorey - kSlab, x = room_.width * 0.5;
  piece("ceiling light", Paint::kLight, {x - 0.4, 3.0, top - 0.08}, {x + 0.4, 3.3, top});
}

void Furnisher::lamp(const Vec3d& foot) {
  turned("lamp", Paint::kLight, foot,
         std::array<Point2, 6>{{{0, 0}, {0.1, 0}, {0.02, 0.3}, {0.15, 0.3}, {0.09, 0.5}, {0, 0.5}}}, 8);
}

void Furnisher::bottle(const Vec3d& foot) {
  turned("drum", Paint::kRedPipe, foot,
         std::array<Point2, 5>{{{0, 0}, {0.25, 0}, {0.25, 0.8}, {0.1, 0.88}, {0, 0.88}}}, 10);
}

void Furnisher::chair(double x, double y, double back_side) {
  piece("chair seat", Paint::kFabric, {x - 0.22, y - 0.22, 0.38}, {x + 0.22, y + 0.22, 0.46});
  piece("chair foot", Paint::kMetal, {x - 0.15, y - 0.15, 0.0}, {x + 0.15, y + 0.15, 0.38});
  const double back = y + back_side * 0.2;
  piece("chair back", Paint::kFabric, {x - 0.22, back - 0.03, 0.5}, {x + 0.22, back + 0.03, 0.95});
}

void Furnisher::bathroom() {
  const double x = room_.width - 1.75, deep = 2.25;
  addWall(mesh_, {.name = room_.name + " bathroom side",
                  .at = {room_.placement.point({x + kInnerWall, 0, 0}), room_.placement.y,
                         room_.placement.x * -1.0, room_.placement.z},
                  .length = deep,
                  .thickness = kInnerWall,
                  .height = kStorey - kSlab,
                  .openings = {{{1.25, 0.0}, {2.0, kDoorHeight}}}});
  addWall(mesh_, {.name = room_.name + " bathroom end",
                  .at = room_.placement.moved({x, deep, 0}),
                  .length = room_.width - x,
                  .thickness = kInnerWall,
                  .height = kStorey - kSlab});
  const double wall = room_.width;
  piece("toilet", Paint::kWhite, {wall - 0.6, 1.5, 0.0}, {wall - 0.2, 1.9, 0.42});
  piece("toilet tank", Paint::kWhite, {wall - 0.18, 1.45, 0.4}, {wall - 0.02, 1.95, 0.9});
  piece("shower tray", Paint::kWhite, {wall - 0.95, 0.02, 0.0}, {wall - 0.02, 0.9, 0.12});
  turned("basin", Paint::kWhite, {x + 0.45, 0.35, 0.0},
         std::array<Point2, 7>{
             {{0, 0}, {0.1, 0}, {0.08, 0.65}, {0.24, 0.8}, {0.24, 0.86}, {0.2, 0.86}, {0, 0.74}}},
         8);
  piece("mirror", Paint::kScreen, {x + 0.2, 0.01, 1.2}, {x + 0.7, 0.03, 1.9});
}

void Furnisher::bed(double y) {
  piece("bed", Paint::kWood, {0.1, y, 0.0}, {2.1, y + 0.95, 0.35});
  piece("mattress", Paint::kFabric, {0.13, y + 0.03, 0.35}, {2.07, y + 0.92, 0.52});
  piece("pillow", Paint::kWhite, {0.16, y + 0.15, 0.52}, {0.56, y + 0.8, 0.62});
}

void Furnisher::desk(double y) {
  const double x = room_.width;
  piece("desk", Paint::kWood, {x - 0.7, y, 0.71}, {x - 0.02, y + 1.3, 0.75});
  piece("desk side", Paint::kWood, {x - 0.68, y + 0.02, 0.0}, {x - 0.02, y + 0.06, 0.71});
  piece("desk drawers", Paint::kWood, {x - 0.66, y + 0.9, 0.0}, {x - 0.04, y + 1.28, 0.71});
  piece("screen", Paint::kScreen, {x - 0.2, y + 0.2, 0.85}, {x - 0.15, y + 0.75, 1.2});
  piece("screen foot", Paint::kMetal, {x - 0.3, y + 0.35, 0.75}, {x - 0.1, y + 0.6, 0.85});
  lamp({x - 0.35, y + 1.1, 0.75});
  chair(x - 1.0, y + 0.45, 1.0);
}

void Furnisher::cabin() {
  bathroom();
  bed(5.3);
  desk(random_.range(2.6, 3.2));
  const double y = random_.range(1.3, 2.4);
  piece("locker", Paint::kMetal, {0.02, y, 0.0}, {0.55, y + 0.9, 2.0});
  piece("locker", Paint::kMetal, {0.02, y + 0.92, 0.0}, {0.55, y + 1.8, random_.chance(0.5) ? 2.0 : 1.1});
  piece("bedside table", Paint::kWood, {2.2, 5.8, 0.0}, {2.7, 6.3, 0.5});
  lamp({2.45, 6.05, 0.5});
  piece("shelf", Paint::kWood, {room_.width - 0.3, 4.7, 1.5}, {room_.width - 0.02, 6.2, 1.54});
  piece("books", Paint::kRedPipe, {room_.width - 0.28, 4.8, 1.54},
        {room_.width - 0.05, random_.range(5.2, 6.1), 1.8});
}

void Furnisher::table(double x, double y) {
  piece("table top", Paint::kWood, {x - 0.45, y - 0.7, 0.71}, {x + 0.45, y + 0.7, 0.75});
  turned("table foot", Paint::kMetal, {x, y, 0.0},
         std::array<Point2, 6>{{{0, 0}, {0.3, 0}, {0.3, 0.03}, {0.06, 0.06}, {0.06, 0.71}, {0, 0.71}}}, 8);
  chair(x, y - 1.0, -1.0);
  chair(x, y + 1.0, 1.0);
  lamp({x, y - 0.3, 0.75});
}

void Furnisher::mess() {
  table(3.0, 1.4);
  table(3.0, 4.8);
  piece("bench", Paint::kFabric, {0.05, 5.8, 0.0}, {2.2, 6.3, 0.45});
  piece("cupboard", Paint::kWood, {0.02, 2.0, 0.0}, {0.45, random_.range(3.0, 5.0), 0.9});
  piece("urn", Paint::kMetal, {0.08, 2.2, 0.9}, {0.4, 2.55, 1.4});
  piece("picture", Paint::kFrame, {room_.width - 0.04, 2.6, 1.3}, {room_.width - 0.01, 3.6, 2.0});
}

void Furnisher::shelves(double y) {
  const double x = room_.width - 0.72;
  mesh_.startObject(room_.name + " shelf posts " + std::to_string(count_++), id(Paint::kMetal));
  mesh_.place(room_.placement);
  for (const double x0 : {x, room_.width - 0.07}) {
    for (const double y0 : {y, y + 1.75}) {
      mesh_.box({x0, y0, 0.0}, {x0 + 0.05, y0 + 0.05, 2.3});
    }
  }
  for (std::uint32_t i = 0; i < 3; ++i) {
    const double z = 0.2 + 0.7 * i;
    piece("shelf", Paint::kMetal, {x, y + 0.05, z}, {room_.width - 0.02, y + 1.75, z + 0.03});
    const double end = random_.range(0.5, 1.6);
    piece("goods", Paint::kCrate, {x + 0.05, y + 0.15, z + 0.03},
          {room_.width - 0.08, y + 0.15 + end, z + random_.range(0.3, 0.6)});
  }
}

void Furnisher::store() {
  shelves(0.4);
  shelves(2.4);
  shelves(4.4);
  for (std::uint32_t i = 0; i < 3; ++i) {
    const double x = 0.1 + 0.9 * i, y = random_.range(5.0, 5.4), side = random_.range(0.5, 0.8);
    piece("crate", Paint::kCrate, {x, y, 0.0}, {x + side, y + side, side});
    piece("crate", Paint::kCrate, {x + 0.05, y + 0.05, side}, {x + side - 0.05, y + side - 0.1, 1.6 * side});
  }
  bottle({0.35, random_.range(1.5, 2.5), 0.0});
  bottle({0.35, random_.range(3.2, 4.4), 0.0});
}

void Furnisher::workshop() {
  const double x = room_.width;
  piece("bench", Paint::kMetal, {x - 0.8, 0.5, 0.8}, {x - 0.02, 5.5, 0.9});
  for (std::uint32_t i = 0; i < 3; ++i) {
    const double y = 0.6 + 1.8 * i;
    piece("bench drawers", Paint::kMachine, {x - 0.75, y, 0.0}, {x - 0.05, y + 0.9, 0.8});
    piece("vice", Paint::kMachine, {x - 0.7, y + 0.2, 0.9}, {x - 0.4, y + 0.4, 1.1});
  }
  mesh_.startObject(room_.name + " drill", id(Paint::kMachine));
  addCylinder(mesh_, room_.placement, {0.4, 3.0, 0.0}, 2, 0.12, 1.7);
  piece("drill head", Paint::kMachine, {0.2, 2.8, 1.7}, {0.65, 3.2, 2.1});
  // One board bent around a corner, so it is not convex.
  mesh_.startObject(room_.name + " tool board", id(Paint::kWood));
  mesh_.place(room_.placement);
  mesh_.prism(
      std::array<Point2, 6>{{{0.02, 4.5}, {0.3, 4.5}, {0.3, 6.0}, {2.5, 6.0}, {2.5, 6.3}, {0.02, 6.3}}}, 0.0,
      1.2);
  bottle({0.35, 2.0, 0.0});
}

}  // namespace

void furnish(MeshBuilder& mesh, const Plan& plan, const Room& room, Random random) {
  const double kind = random.uniform();
  Furnisher furnisher(mesh, room, Random(random.next()));
  furnisher.ceilingLight();
  if (isOnWalk(plan, room)) {
    furnisher.cabin();
  } else if (room.deck < kMainDeckNumber) {
    kind < 0.5 ? furnisher.workshop() : furnisher.store();
  } else if (kind < 0.65) {
    furnisher.cabin();
  } else {
    kind < 0.85 ? furnisher.mess() : furnisher.store();
  }
}

}  // namespace sightline::scenes::ship
