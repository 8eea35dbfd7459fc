#include "scenes/boiler_house.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "scenes/mesh_builder.h"
#include "scenes/random.h"
#include "scenes/round_solids.h"
#include "scenes/stairs.h"
#include "scenes/walk.h"

namespace sightline {
namespace scenes::boiler_house {
namespace {

// The hall, in plan space: x along the row of boilers, y across, z up from the floor; metres.
constexpr double kBay = 8.0, kWidth = 36.0, kHeight = 24.0;
constexpr double kFirstBoiler = 12.0, kBoilerStep = 16.0;
constexpr double kBoilerLength = 10.0, kBoilerSouth = 6.0, kBoilerNorth = 15.0, kBoilerTop = 17.0;
constexpr double kGalleryHeights[] = {4.0, 8.0, 12.0, 16.0};
// One walks between y = 18 and 22 on the floor, and on the gallery at 8 m before the north wall.
constexpr double kGallerySouth = 30.0, kGalleryNorth = 35.0, kWalkHeight = 8.0;
constexpr double kEye = 1.7;
constexpr double kStairRise = 0.2, kStairTread = 0.25;
constexpr std::uint32_t kStairRisers = 40;  // up to kWalkHeight
constexpr double kStairX = 3.0, kStairStart = 20.25;

enum Paint : std::uint32_t {
  kConcrete,
  kSteel,
  kPanel,
  kBand,
  kBrick,
  kGlass,
  kGrating,
  kRail,
  kLagging,
  kGreenPipe,
  kRedPipe,
  kTank,
  kMachine,
  kSheet,
};

std::vector<Material> materials() {
  constexpr Opacity kOpaque = Opacity::kOpaque;
  return {{"concrete", kOpaque, false, {0.42f, 0.41f, 0.39f, 1.0f}},
          {"steel", kOpaque, false, {0.22f, 0.25f, 0.28f, 1.0f}},
          {"panel", kOpaque, false, {0.55f, 0.57f, 0.56f, 1.0f}},
          {"band", kOpaque, false, {0.30f, 0.33f, 0.36f, 1.0f}},
          {"brick", kOpaque, false, {0.44f, 0.20f, 0.14f, 1.0f}},
          {"glass", Opacity::kBlended, true, {0.60f, 0.75f, 0.80f, 0.25f}},
          {"grating", Opacity::kAlphaTested, true, {0.35f, 0.36f, 0.36f, 1.0f}},
          {"rail", kOpaque, false, {0.75f, 0.62f, 0.10f, 1.0f}},
          {"lagging", kOpaque, false, {0.72f, 0.72f, 0.70f, 1.0f}},
          {"green pipe", kOpaque, false, {0.12f, 0.36f, 0.20f, 1.0f}},
          {"red pipe", kOpaque, false, {0.48f, 0.10f, 0.08f, 1.0f}},
          {"tank", kOpaque, false, {0.62f, 0.60f, 0.50f, 1.0f}},
          {"machine", kOpaque, false, {0.16f, 0.28f, 0.42f, 1.0f}},
          {"sheet", kOpaque, false, {0.50f, 0.52f, 0.54f, 1.0f}}};
}

class Hall {
 public:
  Hall(Scene& scene, const BoilerHouseOptions& options)
      : mesh_(scene),
        options_(options),
        random_(options.seed, 1),
        bays_(2 * options.boilers + 3),
        length_(bays_ * kBay) {}

  void build() {
    solid("floor", kConcrete, {-2, -2, -0.5}, {length_ + 2, kWidth + 2, 0});
    addFrame();
    addWalls();
    addRoof();
    for (std::uint32_t i = 0; i < options_.boilers; ++i) {
      addBoiler(i);
    }
    addGalleries();
    addStairs();
    addTanks();
    addPumps();
    addPipes();
  }

  CameraPath walk() const {
    const double north = 0.5 * (kGallerySouth + kGalleryNorth), end = length_ - 3.0;
    const double stairs_end = kStairStart + (kStairRisers - 1) * kStairTread;
    const std::vector<Vec3d> corners{{end, kStairStart, kEye},
                                     {kStairX, kStairStart, kEye},
                                     {kStairX, stairs_end, kEye + kWalkHeight},
                                     {kStairX, north, kEye + kWalkHeight},
                                     {end, north, kEye + kWalkHeight}};
    return walkAlong(roundedRoute(corners, 1.0), {.name = "round",
                                                  .look_ahead = 4.0,
                                                  .glance = 0.8,
                                                  .glance_turns = 9,
                                                  .calm = 3,
                                                  .max_turn = 0.04,
                                                  .far = 500.0});
  }

 private:
  void solid(const std::string& name, Paint paint, const Vec3d& low, const Vec3d& high) {
    mesh_.startObject(name, MaterialId{paint});
    mesh_.box(low, high);
  }
  void cylinder(const std::string& name, Paint paint, const Vec3d& foot, std::uint32_t axis, double radius,
                double length, std::uint32_t segments = 16) {
    mesh_.startObject(name, MaterialId{paint});
    addCylinder(mesh_, {}, foot, axis, radius, length, segments);
    mesh_.place({});
  }
  void tube(const std::string& name, Paint paint, std::span<const Vec3d> corners, double radius) {
    mesh_.startObject(name, MaterialId{paint});
    addTube(mesh_, corners, radius, radius < 0.06 ? 6 : radius < 0.2 ? 8 : 14);
  }
  // A steel section of the shape of an I, from `foot` along an axis (0: x, 1: y, 2: z).
  void beam(const std::string& name, const Vec3d& foot, std::uint32_t axis, double size, double length) {
    const double half = 0.5 * size, web = 0.06 * size, flange = half - 0.1 * size;
    const std::array<Point2, 12> outline{{{-half, -half},
                                          {half, -half},
                                          {half, -flange},
                                          {web, -flange},
                                          {web, flange},
                                          {half, flange},
                                          {half, half},
                                          {-half, half},
                                          {-half, flange},
                                          {-web, flange},
                                          {-web, -flange},
                                          {-half, -flange}}};
    mesh_.startObject(name, MaterialId{kSteel});
    mesh_.place(standingAlong({}, foot, axis));
    mesh_.prism(outline, 0.0, length);
    mesh_.place({});
  }

  void addFrame() {
    for (std::uint32_t i = 0; i <= bays_; ++i) {
      const double x = i * kBay;
      const std::string name = "frame " + std::to_string(i);
      for (const double y : {0.0, kWidth}) {
        beam(name + " column", {x, y, 0}, 2, 0.5, kHeight);
      }
      // A truss: chords, posts and diagonals.
      beam(name + " lower chord", {x, 0, kHeight - 2.0}, 1, 0.3, kWidth);
      beam(name + " upper chord", {x, 0, kHeight}, 1, 0.3, kWidth);
      for (std::uint32_t k = 0; k < 12; ++k) {
        const double y = 3.0 * k;
        const std::string part = name + " " + std::to_string(k);
        beam(part + " post", {x, y, kHeight - 1.85}, 2, 0.12, 1.7);
        const std::array<Vec3d, 2> diagonal{Vec3d(x, y + 0.1, kHeight - 1.8),
                                            Vec3d(x, y + 2.9, kHeight - 0.2)};
        tube(part + " diagonal", kSteel, diagonal, 0.05);
      }
      for (const double z : {6.0, 12.0, 18.0}) {
        if (i < bays_) {
          beam(name + " rail south", {x + 0.25, 0, z}, 0, 0.25, kBay - 0.5);
          beam(name + " rail north", {x + 0.25, kWidth, z}, 0, 0.25, kBay - 0.5);
        }
      }
    }
    for (std::uint32_t k = 1; k < 12; ++k) {
      beam("purlin " + std::to_string(k), {0, 3.0 * k, kHeight + 0.25}, 0, 0.2, length_);
    }
  }

  // Panes in frames of thin bars, between two corners of a wall's plane. along: the horizontal axis.
  void addPanes(const std::string& name, const Vec3d& low, const Vec3d& high, int along) {
    constexpr double kBar = 0.03;
    const int across = 1 - along;
    const double width = high[along] - low[along], height = high.z - low.z;
    const auto columns = static_cast<std::uint32_t>(std::max(1.0, std::floor(width / 1.3)));
    const auto rows = static_cast<std::uint32_t>(std::max(1.0, std::floor(height / 1.0)));
    mesh_.startObject(name + " panes", MaterialId{kGlass});
    const Vec3d right = along == 0 ? Vec3d(width, 0, 0) : Vec3d(0, width, 0), up(0, 0, height);
    mesh_.quad(low, low + right, low + right + up, low + up);
    const auto bar = [&](const std::string& kind, const Vec3d& from, const Vec3d& to) {
      Vec3d a = from, b = to;
      a[across] -= kBar;
      b[across] += kBar;
      solid(name + kind, kSteel, a, b);
    };
    for (std::uint32_t c = 0; c <= columns; ++c) {
      Vec3d from = low, to = high;
      from[along] = low[along] + width * c / columns - kBar;
      to[along] = from[along] + 2 * kBar;
      bar(" mullion " + std::to_string(c), from, to);
    }
    for (std::uint32_t r = 0; r <= rows; ++r) {
      Vec3d from = low, to = high;
      from.z = low.z + height * r / rows - kBar;
      to.z = from.z + 2 * kBar;
      bar(" transom " + std::to_string(r), from, to);
    }
  }

  void addWalls() {
    for (std::uint32_t i = 0; i < bays_; ++i) {
      const double x0 = i * kBay + 0.25, x1 = (i + 1) * kBay - 0.25;
      for (const bool north : {false, true}) {
        const double y = north ? kWidth : 0.0;
        const std::string name = (north ? "north wall " : "south wall ") + std::to_string(i);
        solid(name + " brick", kBrick, {x0, y - 0.15, 0}, {x1, y + 0.15, 3.0});
        for (const double z : {3.2, 6.2, 12.2, 18.2}) {
          const double top = z < 6.0 ? 5.8 : z + 5.6;
          if (random_.chance(0.75)) {
            addPanes(name + " at " + std::to_string(static_cast<int>(z)), {x0, y, z}, {x1, y, top}, 0);
          } else {
            solid(name + " sheet at " + std::to_string(static_cast<int>(z)), kSheet, {x0, y - 0.02, z},
                  {x1, y + 0.02, top});
          }
        }
      }
    }
    for (const bool east : {false, true}) {
      const double x = east ? length_ : 0.0;
      const std::string name = east ? "east wall" : "west wall";
      solid(name + " brick", kBrick, {x - 0.15, 0.3, 0}, {x + 0.15, kWidth - 0.3, 3.0});
      for (std::uint32_t k = 0; k < 4; ++k) {
        const double y = 0.3 + k * 8.85;
        addPanes(name + " " + std::to_string(k), {x, y, 3.2}, {x, y + 8.7, kHeight - 2.2}, 1);
      }
    }
  }

  void addRoof() {
    for (std::uint32_t i = 0; i < bays_; ++i) {
      for (std::uint32_t k = 0; k < 12; ++k) {
        const std::string name = "roof " + std::to_string(i) + " " + std::to_string(k);
        const Vec3d low(i * kBay, 3.0 * k, kHeight + 0.36), high(low + Vec3d(kBay, 3.0, 0.05));
        if (k % 4 == 1) {
          mesh_.startObject(name, MaterialId{kGlass});
          mesh_.quad(low, {high.x, low.y, low.z}, {high.x, high.y, low.z}, {low.x, high.y, low.z});
        } else {
          solid(name, kSheet, low, high);
        }
      }
    }
  }

  void addBoiler(std::uint32_t number) {
    const std::string name = "boiler " + std::to_string(number);
    const double x0 = kFirstBoiler + number * kBoilerStep, x1 = x0 + kBoilerLength;
    // The casing: panels with bands of steel around them, above a hopper with burners before it.
    const double bottom = 2.0, panel_height = 2.5;
    for (std::uint32_t k = 0; bottom + k * panel_height < kBoilerTop - 1.0; ++k) {
      const double z = bottom + k * panel_height;
      solid(name + " casing " + std::to_string(k), kPanel, {x0, kBoilerSouth, z},
            {x1, kBoilerNorth, z + panel_height - 0.2});
      solid(name + " band " + std::to_string(k), kBand,
            {x0 - 0.15, kBoilerSouth - 0.15, z + panel_height - 0.2},
            {x1 + 0.15, kBoilerNorth + 0.15, z + panel_height});
    }
    for (std::uint32_t k = 0; k < 4; ++k) {
      const Vec3d foot(k % 2 == 0 ? x0 + 0.5 : x1 - 0.5, k < 2 ? kBoilerSouth + 0.5 : kBoilerNorth - 0.5, 0);
      beam(name + " leg " + std::to_string(k), foot, 2, 0.4, bottom);
    }
    for (std::uint32_t k = 0; k < 6; ++k) {
      const double x = x0 + 1.5 + 3.0 * (k % 3), z = 4.0 + 3.0 * (k / 3);
      cylinder(name + " burner " + std::to_string(k), kMachine, {x, kBoilerNorth + 0.15, z}, 1, 0.5, 1.2);
    }
    // The drum, and pipes from it to the header.
    const Vec3d drum(x0 - 0.5, 10.0, kBoilerTop + 1.5);
    mesh_.startObject(name + " drum", MaterialId{kLagging});
    mesh_.place(standingAlong({}, drum, 0));
    std::vector<Point2> profile = halfCircle(1.1, 1.1, 8);
    for (std::size_t i = profile.size() / 2; i < profile.size(); ++i) {
      profile[i].y += kBoilerLength - 1.2;
    }
    mesh_.lathe(profile, 24);
    mesh_.place({});
    for (std::uint32_t k = 0; k < 12; ++k) {
      const double x = x0 + 0.5 + 0.8 * k, z = random_.range(5.0, 15.0);
      const std::array<Vec3d, 4> line{Vec3d(x, 10.0, kBoilerTop + 0.5), Vec3d(x, 16.2, kBoilerTop + 0.5),
                                      Vec3d(x, 16.2, z), Vec3d(x, kBoilerNorth, z)};
      tube(name + " downcomer " + std::to_string(k), k % 3 == 0 ? kLagging : kGreenPipe, line,
           random_.range(0.05, 0.14));
    }
    // Ducts to the south wall and along it.
    solid(name + " duct", kSheet, {x0 + 2, 2.6, 10}, {x0 + 5, kBoilerSouth - 0.2, 13});
    solid(name + " riser", kSheet, {x0 + 2, 1.0, 4}, {x0 + 5, 2.5, 20});
    cylinder(name + " fan", kMachine, {x0 + 6, 3.5, 1.6}, 0, 1.5, 1.2, 24);
  }

  // A strip of grating with its edge beams and handrails; rails: on its south and its north side.
  void addGallery(const std::string& name, const Vec3d& low, const Vec3d& high, bool south, bool north) {
    mesh_.startObject(name + " grating", MaterialId{kGrating});
    mesh_.quad(low, {high.x, low.y, low.z}, {high.x, high.y, low.z}, {low.x, high.y, low.z});
    for (const bool at_north : {false, true}) {
      const double y = at_north ? high.y : low.y;
      const std::string side = name + (at_north ? " north" : " south");
      solid(side + " edge", kSteel, {low.x, y - 0.05, low.z - 0.25}, {high.x, y + 0.05, low.z - 0.02});
      if (at_north ? !north : !south) {
        continue;
      }
      for (const double up : {0.55, 1.1}) {
        const std::array<Vec3d, 2> line{Vec3d(low.x, y, low.z + up), Vec3d(high.x, y, low.z + up)};
        tube(side + (up < 1.0 ? " knee rail" : " hand rail"), kRail, line, 0.025);
      }
      for (double x = low.x; x < high.x; x += 2.0) {
        cylinder(side + " post " + std::to_string(static_cast<int>(x)), kRail, {x, y, low.z}, 2, 0.025, 1.1,
                 6);
      }
    }
  }

  void addGalleries() {
    const double end = length_ - 1.0;
    for (const double z : kGalleryHeights) {
      const std::string name = "gallery at " + std::to_string(static_cast<int>(z));
      for (std::uint32_t i = 0; i < options_.boilers; ++i) {
        const double x = kFirstBoiler + i * kBoilerStep;
        const std::string part = name + " " + std::to_string(i);
        addGallery(part + " before", {x - 2, kBoilerNorth + 1.5, z}, {x + kBoilerLength + 2, 18.0, z}, false,
                   true);
        addGallery(part + " between", {x + kBoilerLength + 0.3, 4.0, z},
                   {x + kBoilerStep - 0.3, kBoilerNorth + 1.5, z}, true, false);
      }
      addGallery(name + " north", {1.0, kGallerySouth, z}, {end, kGalleryNorth, z}, true, false);
      for (double x = kBay; x < end; x += kBay) {
        beam(name + " hanger " + std::to_string(static_cast<int>(x)), {x, kGallerySouth - 0.2, z - 0.4}, 1,
             0.25, kWidth - kGallerySouth);
      }
    }
  }

  void addStairs() {
    mesh_.startObject("stairs", MaterialId{kSteel});
    const Placement north{{kStairX + 0.6, kStairStart, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}};
    mesh_.place(north.moved({0, 0, -1.2}));
    mesh_.prism(flightProfile(kStairRisers, kStairRise, kStairTread), 0.0, 1.2);
    mesh_.place({});
  }

  void addTanks() {
    for (std::uint32_t i = 0; i < 2 * options_.boilers; ++i) {
      const double x = 9.0 + i * 8.0, radius = random_.range(1.2, 2.2), height = random_.range(3.0, 3.6);
      const std::string name = "tank " + std::to_string(i);
      cylinder(name, kTank, {x, 27.0, 0.6}, 2, radius, height - 0.6, 28);
      for (std::uint32_t k = 0; k < 4; ++k) {
        const Point2 d = unitVector(0.25 * k + 0.125) * (0.8 * radius);
        cylinder(name + " leg " + std::to_string(k), kSteel, {x + d.x, 27.0 + d.y, 0}, 2, 0.08, 0.6, 6);
      }
    }
  }

  void addPumps() {
    for (std::uint32_t i = 0; i < 6 * options_.boilers; ++i) {
      const double x = 6.0 + i * 2.7;
      const double y = 23.6, size = random_.range(0.7, 1.1);
      const std::string name = "pump " + std::to_string(i);
      solid(name + " base", kConcrete, {x, y, 0}, {x + 1.6, y + 0.9, 0.2});
      cylinder(name + " motor", kMachine, {x + 0.1, y + 0.45, 0.2 + 0.35 * size}, 0, 0.35 * size, 0.8 * size);
      cylinder(name + " volute", kGreenPipe, {x + 0.2 + 0.85 * size, y + 0.45, 0.2 + 0.4 * size}, 0,
               0.4 * size, 0.3 * size, 20);
    }
  }

  // Pipes along the hall at the heights of racks, with a leg down or across at each end.
  void addPipes() {
    for (std::uint32_t i = 0; i < options_.pipes; ++i) {
      const std::string name = "pipe " + std::to_string(i);
      const bool large = random_.chance(0.08);
      const double radius = large ? random_.range(0.18, 0.4) : random_.range(0.02, 0.12);
      const double z = kGalleryHeights[random_.below(4)] + random_.range(2.6, 3.4);
      const double y = random_.chance(0.6) ? random_.range(22.6, 29.4) : random_.range(1.0, 29.4);
      const double x = random_.range(5.0, length_ - 20.0), run = random_.range(3.0, 14.0);
      const double across = std::clamp(y + random_.range(-6.0, 6.0), 0.8, 29.6);
      const bool down = !large && y > 23.0 && random_.chance(0.5);
      const double to = down ? random_.range(1.0, z - 1.0) : z;
      std::vector<Vec3d> line{{x, y, z}, {x + run, y, z}};
      if (down) {
        line.insert(line.begin(), {x, y, to});
      } else if (std::abs(across - y) > 2.0 * radius + 0.2) {
        line.emplace_back(x + run, across, z);
      }
      const double colour = random_.uniform();
      tube(name, colour < 0.5 ? kLagging : colour < 0.8 ? kGreenPipe : kRedPipe, line, radius);
    }
  }

  MeshBuilder mesh_;
  const BoilerHouseOptions& options_;
  Random random_;
  std::uint32_t bays_;
  double length_;
};

}  // namespace
}  // namespace scenes::boiler_house

Scene makeBoilerHouse(const BoilerHouseOptions& options) {
  using namespace scenes;
  Scene scene;
  scene.materials = boiler_house::materials();
  {
    boiler_house::Hall hall(scene, options);
    hall.build();
    scene.paths = {hall.walk()};
  }
  weldPositions(scene);
  updateBounds(scene);
  return scene;
}

}  // namespace sightline
