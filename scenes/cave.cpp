// The plan of the cave, its walk, and the assembly of the scene.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "scenes/cave_parts.h"
#include "scenes/landscapes.h"
#include "scenes/walk.h"

namespace sightline {
namespace scenes::cave {
namespace {

constexpr double kPitch = 36.0;  // between the middles of neighbouring halls, metres
constexpr std::uint32_t kWalkHalls = 12;

std::vector<Material> materials() {
  constexpr Opacity kOpaque = Opacity::kOpaque;
  return {{"limestone", kOpaque, false, {0.42f, 0.37f, 0.30f, 1.0f}},
          {"dark limestone", kOpaque, false, {0.37f, 0.32f, 0.26f, 1.0f}},
          {"dripstone", kOpaque, false, {0.55f, 0.50f, 0.42f, 1.0f}},
          {"boulder", kOpaque, false, {0.28f, 0.27f, 0.26f, 1.0f}},
          {"crate", kOpaque, false, {0.40f, 0.24f, 0.10f, 1.0f}},
          {"barrel", kOpaque, false, {0.33f, 0.12f, 0.06f, 1.0f}},
          {"iron", kOpaque, false, {0.12f, 0.12f, 0.13f, 1.0f}},
          {"flame", kOpaque, false, {0.95f, 0.75f, 0.30f, 1.0f}}};
}

Hall anyHall(double column, double row, Random& random) {
  const double x = kPitch * column + random.range(-5.0, 5.0), y = kPitch * row + random.range(-5.0, 5.0);
  const double z = random.range(-4.0, 4.0);
  const double length = random.range(7.0, 12.5), width = random.range(7.0, 12.5);
  return {{x, y, z}, {length, width, random.range(5.0, 9.0)}};
}

// The point of a hall where a tunnel in this direction leaves it, as high as its middle.
Vec3d exitOf(const Hall& hall, const Vec3d& direction) {
  const Vec3d flat = normalized(Vec3d(direction.x, direction.y, 0.0));
  return hall.eye + flat * (0.85 * std::min(hall.radii.x, hall.radii.y));
}

Tunnel anyTunnel(const Hall& from, const Hall& to, Random& random) {
  const Vec3d d = to.eye - from.eye, side = normalized(Vec3d(-d.y, d.x, 0.0));
  const double turn = random.chance(0.5) ? 1.0 : -1.0;
  const double bend = turn * random.range(2.0, 7.0);
  const Vec3d a = exitOf(from, d), b = exitOf(to, d * -1.0);
  return {{from.eye, a, (a + b) * 0.5 + side * bend, b, to.eye}, random.range(2.2, 3.2)};
}

}  // namespace

// The halls follow each other in rows, to and fro; a tunnel leads from each to the next. A third of the other
// neighbours are joined too.
Plan makePlan(std::uint32_t halls, Random random) {
  Plan plan;
  std::uint32_t columns = 1;
  while (columns * columns < halls) {
    ++columns;
  }
  const auto columnOf = [&](std::uint32_t i) {
    return i / columns % 2 == 0 ? i % columns : columns - 1 - i % columns;
  };
  for (std::uint32_t i = 0; i < halls; ++i) {
    plan.halls.push_back(anyHall(columnOf(i), i / columns, random));
  }
  for (std::uint32_t i = 0; i + 1 < halls; ++i) {
    plan.tunnels.push_back(anyTunnel(plan.halls[i], plan.halls[i + 1], random));
  }
  for (std::uint32_t i = 0; i < halls; ++i) {
    const std::uint32_t next = (i / columns + 1) * columns * 2 - 1 - i;  // in the same column of the next row
    if (next < halls && next > i + 1 && random.chance(0.33)) {
      plan.tunnels.push_back(anyTunnel(plan.halls[i], plan.halls[next], random));
    }
  }
  return plan;
}

std::vector<Vec3d> walkLine(const Plan& plan) {
  std::vector<Vec3d> corners;
  for (std::size_t i = 0; i + 1 < std::min<std::size_t>(plan.halls.size(), kWalkHalls); ++i) {
    const std::vector<Vec3d>& line = plan.tunnels[i].corners;
    corners.insert(corners.end(), line.begin(), line.end() - 1);
  }
  // Ends before the middle of the last hall.
  corners.push_back(plan.tunnels[std::min<std::size_t>(plan.halls.size(), kWalkHalls) - 2].corners.back());
  return roundedRoute(corners, 4.0);
}

}  // namespace scenes::cave

Scene makeCave(const CaveOptions& options) {
  using namespace scenes;
  Scene scene;
  scene.materials = cave::materials();
  const cave::Plan plan = cave::makePlan(options.halls, Random(options.seed, 1));
  const ValueGrid grid = cave::hollow(plan, options.triangles, Random(options.seed, 2).next());
  {
    MeshBuilder mesh(scene);
    cave::addRock(mesh, grid);
    cave::addThings(mesh, plan, grid, options.seed);
  }
  weldPositions(scene);
  updateBounds(scene);
  scene.paths = {
      walkAlong(cave::walkLine(plan),
                {.name = "tunnels", .look_ahead = 3.0, .calm = 3, .max_turn = 0.06, .far = 600.0})};
  return scene;
}

}  // namespace sightline
