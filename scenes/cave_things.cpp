// What stands and hangs in the cave.

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "scenes/cave_parts.h"
#include "scenes/free_ground.h"
#include "scenes/nature.h"
#include "scenes/walk.h"

namespace sightline::scenes::cave {
namespace {

// The depth in the rock between grid points.
double depthAt(const ValueGrid& grid, const Vec3d& p) {
  std::array<std::uint32_t, 3> low{};
  std::array<double, 3> part{};
  for (int axis = 0; axis < 3; ++axis) {
    const double at = std::clamp((p[axis] - grid.origin[axis]) / grid.cell, 0.0, grid.points[axis] - 1.001);
    low[axis] = static_cast<std::uint32_t>(at);
    part[axis] = at - low[axis];
  }
  double sum = 0.0;
  for (std::uint32_t k = 0; k < 8; ++k) {
    double weight = 1.0;
    std::array<std::uint32_t, 3> corner = low;
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      const bool upper = (k >> axis & 1) != 0;
      weight *= upper ? part[axis] : 1.0 - part[axis];
      corner[axis] += upper ? 1 : 0;
    }
    sum += weight * grid.values[grid.index(corner[0], corner[1], corner[2])];
  }
  return sum;
}

// The first point of the rock from p along the vertical, upwards (1) or downwards (-1), at most 20 m away;
// nothing if p is in the rock or there is no rock.
std::optional<Vec3d> rockFrom(const ValueGrid& grid, const Vec3d& p, double up) {
  constexpr double kStep = 0.1;
  if (depthAt(grid, p) > 0.0) {
    return std::nullopt;
  }
  for (int i = 1; i < 200; ++i) {
    const Vec3d at = p + Vec3d(0, 0, up * kStep * i);
    if (depthAt(grid, at) > 0.0) {
      return at;
    }
  }
  return std::nullopt;
}

class Things {
 public:
  Things(MeshBuilder& mesh, const Plan& plan, const ValueGrid& grid, std::uint64_t seed)
      : mesh_(mesh), plan_(plan), grid_(grid), random_(seed, 3) {
    free_.keepLine(walkLine(plan), 0.9);
  }

  void build() {
    for (const Hall& hall : plan_.halls) {
      const auto anywhere = [&] { return inHall(hall); };
      const double size = hall.radii.x * hall.radii.y / 90.0;
      fill(anywhere, size);
    }
    for (const Tunnel& tunnel : plan_.tunnels) {
      const std::vector<Vec3d> line = roundedRoute(tunnel.corners, 4.0);
      fill([&] { return besideLine(line, tunnel.radius); }, 0.4);
    }
  }

 private:
  Vec3d inHall(const Hall& hall) {
    const Point2 direction = unitVector(random_.uniform());
    const Point2 d = direction * std::sqrt(random_.range(0.02, 0.85));
    return hall.eye + Vec3d(d.x * hall.radii.x, d.y * hall.radii.y, 0.0);
  }
  Vec3d besideLine(const std::vector<Vec3d>& line, double radius) {
    const std::uint32_t leg = random_.below(static_cast<std::uint32_t>(line.size()) - 1);
    const Vec3d d = line[leg + 1] - line[leg];
    const Vec3d at = line[leg] + d * random_.uniform();
    const double side = random_.chance(0.5) ? radius : -radius;
    const double aside = side * random_.range(0.45, 0.95);
    return at + normalized(Vec3d(-d.y, d.x, 0.0)) * aside;
  }

  // Things for a place of this size; `anywhere` gives points at eye height.
  template <typename Anywhere>
  void fill(const Anywhere& anywhere, double size) {
    const auto times = [&](double count, auto add) {
      const auto n = static_cast<int>(count * size + random_.uniform());
      for (int i = 0; i < n; ++i) {
        (this->*add)(anywhere());
      }
    };
    times(3.0, &Things::lamp);
    times(5.0, &Things::crates);
    times(5.0, &Things::barrel);
    times(9.0, &Things::boulder);
    times(16.0, &Things::stalagmite);
    times(14.0, &Things::stalactite);
  }

  // The floor below the point if a circle of this radius is free and about flat there, as high as its lowest
  // part; takes the circle.
  std::optional<Vec3d> floorFor(const Vec3d& p, double radius) {
    std::optional<Vec3d> floor = rockFrom(grid_, p, -1.0);
    for (int i = 0; floor && i < 4; ++i) {
      const Point2 d = unitVector(0.25 * i) * (0.8 * radius);
      const std::optional<Vec3d> beside = rockFrom(grid_, p + Vec3d(d.x, d.y, 0.0), -1.0);
      if (!beside || std::abs(beside->z - floor->z) > 0.6 * radius + 0.2) {
        return std::nullopt;
      }
      floor->z = std::min(floor->z, beside->z);
    }
    return floor && free_.tryCircle({p.x, p.y}, radius) ? floor : std::nullopt;
  }
  std::string name(const char* kind) { return std::string(kind) + " " + std::to_string(number_++); }

  void lamp(const Vec3d& p) {
    const std::optional<Vec3d> floor = floorFor(p, 0.3);
    if (!floor) {
      return;
    }
    mesh_.place({*floor});
    mesh_.startObject(name("lamp post"), MaterialId{kIron});
    mesh_.lathe(std::array<Point2, 5>{{{0, -0.3}, {0.12, -0.3}, {0.05, 0.2}, {0.04, 1.9}, {0, 1.9}}}, 6);
    mesh_.startObject(name("lamp"), MaterialId{kFlame});
    mesh_.lathe(std::array<Point2, 4>{{{0, 1.92}, {0.13, 1.98}, {0.1, 2.2}, {0, 2.32}}}, 6);
  }

  void crates(const Vec3d& p) {
    const double half = random_.range(0.3, 0.55);
    const std::optional<Vec3d> floor = floorFor(p, 1.5 * half);
    if (!floor) {
      return;
    }
    const std::uint32_t count = random_.between(1, 3);
    double foot = -0.15;
    for (std::uint32_t i = 0; i < count; ++i) {
      const double side = half * (1.0 - 0.15 * i);
      mesh_.place(Placement{*floor + Vec3d(0, 0, foot)}.turned(random_.uniform()));
      mesh_.startObject(name("crate"), MaterialId{kCrate});
      mesh_.box({-side, -side, 0.0}, {side, side, 2.0 * side});
      foot += 2.0 * side + 0.003;
    }
  }

  void barrel(const Vec3d& p) {
    const double r = random_.range(0.25, 0.36), h = r * 2.9;
    if (const std::optional<Vec3d> floor = floorFor(p, r * 1.2)) {
      mesh_.place({*floor - Vec3d(0, 0, 0.1)});
      mesh_.startObject(name("barrel"), MaterialId{kBarrel});
      mesh_.lathe(std::array<Point2, 5>{{{0, 0}, {0.85 * r, 0}, {r, 0.5 * h}, {0.85 * r, h}, {0, h}}}, 12);
    }
  }

  void boulder(const Vec3d& p) {
    const double any = random_.uniform(), radius = 0.3 + 1.1 * any * any;
    if (const std::optional<Vec3d> floor = floorFor(p, radius * 1.2)) {
      addStone(mesh_, {*floor - Vec3d(0, 0, 0.1)}, radius, MaterialId{kBoulder}, random_, name("boulder"));
    }
  }

  // A cone of dripstone of this height, from 0.6 m in the rock.
  void cone(double radius, double height) {
    std::array<Point2, 7> profile{{{0.0, -0.6}, {radius * 1.3, -0.6}}};
    for (std::size_t i = 0; i < 4; ++i) {
      const double t = 0.25 * static_cast<double>(i);
      profile[2 + i] = {radius * (1.0 - t * (1.5 - 0.5 * t)) * random_.range(0.85, 1.1), height * t};
    }
    profile[6] = {0.0, height};
    mesh_.lathe(profile, 9);
  }

  void stalagmite(const Vec3d& p) {
    const double radius = random_.range(0.2, 0.7);
    if (const std::optional<Vec3d> floor = floorFor(p, radius * 1.3)) {
      mesh_.place(Placement{*floor}.turned(random_.uniform()));
      mesh_.startObject(name("stalagmite"), MaterialId{kDripstone});
      cone(radius, radius * random_.range(3.0, 7.0));
    }
  }

  // Ends above the heads of those who walk below.
  void stalactite(const Vec3d& p) {
    const double radius = random_.range(0.12, 0.5);
    const double wanted = radius * random_.range(3.0, 8.0);
    const std::optional<Vec3d> ceiling = rockFrom(grid_, p, 1.0);
    const double height = ceiling ? std::min(wanted, ceiling->z - p.z - 1.0) : 0.0;
    if (height > 2.0 * radius) {
      mesh_.place({*ceiling, {1, 0, 0}, {0, -1, 0}, {0, 0, -1}});
      mesh_.startObject(name("stalactite"), MaterialId{kDripstone});
      cone(radius, height);
    }
  }

  MeshBuilder& mesh_;
  const Plan& plan_;
  const ValueGrid& grid_;
  Random random_;
  FreeGround free_;
  std::uint32_t number_ = 0;
};

}  // namespace

void addThings(MeshBuilder& mesh, const Plan& plan, const ValueGrid& grid, std::uint64_t seed) {
  Things(mesh, plan, grid, seed).build();
}

}  // namespace sightline::scenes::cave
