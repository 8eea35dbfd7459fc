// The free space of the cave, and its surface.

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "scenes/cave_parts.h"
#include "scenes/noise.h"
#include "scenes/walk.h"

namespace sightline::scenes::cave {
namespace {

constexpr float kSolid = 10.0f;       // depth far from all free space, metres
constexpr double kMargin = 2.5;       // around halls and tunnels within which the depth is computed
constexpr double kBlend = 1.2;        // radius of the edges where halls and tunnels join, metres
constexpr double kChunk = 12.0;       // side of a cube of rock that is one object, metres
constexpr double kCoarseCell = 1.25;  // of the grid by which the number of triangles is estimated, metres

constexpr double kFinestCell = 0.2;  // metres

struct Extent {
  Vec3d min, max;
};

// The smaller of two depths, rounded where they are about equal.
double smoothMin(double a, double b, double radius) {
  const double t = std::max(radius - std::abs(a - b), 0.0) / radius;
  return std::min(a, b) - t * t * radius * 0.25;
}
double smoothMax(double a, double b, double radius) {
  return -smoothMin(-a, -b, radius);
}

double wallNoise(const Vec3d& p, std::uint64_t seed) {
  return 1.1 * fractalNoise(p / 5.0, 3, seed);
}

// Depth below the floor and behind the wall together.
double hollowed(double wall, double floor, const Vec3d& p, std::uint64_t seed) {
  const double rough_wall = std::abs(wall) < 1.9 && floor < wall + kMargin ? wall + wallNoise(p, seed) : wall;
  const double rough_floor =
      std::abs(floor) < 1.0 ? floor + 0.25 * fractalNoise(Point2{p.x, p.y} / 3.0, 2, seed + 8) : floor;
  return smoothMax(rough_wall, rough_floor, 0.6);
}

double depthOf(const Hall& hall, const Vec3d& p, std::uint64_t seed) {
  const Vec3d from = p - hall.eye, r = hall.radii;
  const Vec3d scaled(from.x / r.x, from.y / r.y, from.z / r.z);
  const Vec3d gradient(scaled.x / r.x, scaled.y / r.y, scaled.z / r.z);
  const double k = length(scaled), steep = length(gradient);
  const double wall = steep > 1e-9 ? k * (k - 1.0) / steep : -r.z;
  return hollowed(wall, -from.z - kEyeHeight, p, seed);
}

double depthOf(std::span<const Vec3d> line, double radius, const Vec3d& p, std::uint64_t seed) {
  double nearest = 1e30, eye_height = 0.0;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Vec3d d = line[i + 1] - line[i];
    const double t = std::clamp(dot(p - line[i], d) / dot(d, d), 0.0, 1.0);
    const Vec3d at = line[i] + d * t;
    const double square = dot(p - at, p - at);
    if (square < nearest) {
      nearest = square;
      eye_height = at.z;
    }
  }
  return hollowed(std::sqrt(nearest) - radius, eye_height - p.z - kEyeHeight, p, seed);
}

// Few points of a tunnel's rounded line.
std::vector<Vec3d> thinLine(const Tunnel& tunnel) {
  const std::vector<Vec3d> dense = roundedRoute(tunnel.corners, 4.0);
  std::vector<Vec3d> line;
  for (std::size_t i = 0; i < dense.size(); i += 6) {
    line.push_back(dense[i]);
  }
  line.push_back(dense.back());
  return line;
}

Extent extentOf(std::span<const Vec3d> line, const Vec3d& radii) {
  Extent extent{line.front(), line.front()};
  for (const Vec3d& p : line) {
    extent = {min(extent.min, p), max(extent.max, p)};
  }
  const Vec3d reach = radii + Vec3d(kMargin, kMargin, kMargin);
  return {extent.min - reach, extent.max + reach};
}

// Joins the depth that a function gives with the grid's within the extent.
template <typename Depth>
void carve(ValueGrid& grid, const Extent& extent, const Depth& depth) {
  std::array<std::uint32_t, 3> low{}, high{};
  for (int axis = 0; axis < 3; ++axis) {
    const double first = (extent.min[axis] - grid.origin[axis]) / grid.cell;
    const double last = (extent.max[axis] - grid.origin[axis]) / grid.cell;
    low[axis] = static_cast<std::uint32_t>(std::clamp(first, 0.0, grid.points[axis] - 1.0));
    high[axis] = static_cast<std::uint32_t>(std::clamp(last, 0.0, grid.points[axis] - 1.0));
  }
  for (std::uint32_t z = low[2]; z <= high[2]; ++z) {
    for (std::uint32_t y = low[1]; y <= high[1]; ++y) {
      for (std::uint32_t x = low[0]; x <= high[0]; ++x) {
        float& value = grid.values[grid.index(x, y, z)];
        value = static_cast<float>(smoothMin(value, depth(grid.point(x, y, z)), kBlend));
      }
    }
  }
}

Vec3d halfway(const Vec3d& low) {
  return Vec3d(std::floor(low.x) + 0.5, std::floor(low.y) + 0.5, std::floor(low.z) + 0.5);
}

enum class Origin { kAnywhere, kHalfway };  // kHalfway: between whole coordinates

ValueGrid hollowWithCells(const Plan& plan, double cell, Origin origin, std::uint64_t seed) {
  Extent whole{plan.halls.front().eye, plan.halls.front().eye};
  const auto include = [&](const Extent& extent) {
    whole = {min(whole.min, extent.min), max(whole.max, extent.max)};
  };
  std::vector<std::vector<Vec3d>> lines;
  for (const Hall& hall : plan.halls) {
    include(extentOf(std::span(&hall.eye, 1), hall.radii));
  }
  for (const Tunnel& tunnel : plan.tunnels) {
    lines.push_back(thinLine(tunnel));
    include(extentOf(lines.back(), Vec3d(1, 1, 1) * tunnel.radius));
  }
  ValueGrid grid;
  grid.origin = origin == Origin::kHalfway ? halfway(whole.min) : whole.min;
  grid.cell = cell;
  for (int axis = 0; axis < 3; ++axis) {
    grid.points[axis] = static_cast<std::uint32_t>((whole.max - whole.min)[axis] / cell) + 2;
  }
  grid.values.assign(std::size_t{grid.points[0]} * grid.points[1] * grid.points[2], kSolid);
  for (const Hall& hall : plan.halls) {
    carve(grid, extentOf(std::span(&hall.eye, 1), hall.radii),
          [&](const Vec3d& p) { return depthOf(hall, p, seed); });
  }
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const double radius = plan.tunnels[i].radius;
    carve(grid, extentOf(lines[i], Vec3d(1, 1, 1) * radius),
          [&](const Vec3d& p) { return depthOf(lines[i], radius, p, seed); });
  }
  keepConnected(grid, plan.halls.front().eye);
  fillPinches(grid);
  // What the filling has cut off is too small to be entered.
  keepConnected(grid, plan.halls.front().eye);
  return grid;
}

}  // namespace

ValueGrid hollow(const Plan& plan, std::uint32_t triangles, std::uint64_t seed) {
  const auto coarse = static_cast<double>(
      surfaceNet(hollowWithCells(plan, kCoarseCell, Origin::kAnywhere, seed)).quads.size());
  const double cell = kCoarseCell * std::sqrt(2.0 * coarse / triangles);
  return hollowWithCells(plan, std::max(cell, kFinestCell), Origin::kAnywhere, seed);
}

ValueGrid hollowCubes(const Plan& plan, std::uint64_t seed) {
  return hollowWithCells(plan, 1.0, Origin::kHalfway, seed);
}

void addRock(MeshBuilder& mesh, const ValueGrid& grid) {
  const SurfaceNet net = surfaceNet(grid);
  std::map<std::array<int, 3>, std::vector<std::size_t>> chunks;
  for (std::size_t i = 0; i < net.quads.size(); ++i) {
    const Vec3d from = (net.points[net.quads[i][0]] - grid.origin) / kChunk;
    chunks[{static_cast<int>(from.x), static_cast<int>(from.y), static_cast<int>(from.z)}].push_back(i);
  }
  mesh.place({});
  // For each point, this holds the number of the last chunk that it is in, and its place there.
  std::vector<std::pair<std::size_t, std::uint32_t>> last(net.points.size());
  std::size_t number = 0;
  for (const auto& [chunk, quads] : chunks) {
    ++number;
    std::vector<Vec3d> points;
    std::vector<std::uint32_t> indices;
    const auto vertex = [&](std::uint32_t at) {
      if (last[at].first != number) {
        last[at] = {number, static_cast<std::uint32_t>(points.size())};
        points.push_back(net.points[at]);
      }
      return last[at].second;
    };
    for (const std::size_t i : quads) {
      std::array<std::uint32_t, 4> q{};
      std::transform(net.quads[i].begin(), net.quads[i].end(), q.begin(), vertex);
      if (length(points[q[0]] - points[q[2]]) <= length(points[q[1]] - points[q[3]])) {
        indices.insert(indices.end(), {q[0], q[1], q[2], q[0], q[2], q[3]});
      } else {
        indices.insert(indices.end(), {q[1], q[2], q[3], q[1], q[3], q[0]});
      }
    }
    const Surface surface = (chunk[0] + chunk[1] + chunk[2]) % 2 == 0 ? kLimestone : kDarkLimestone;
    mesh.startObject(
        "rock " + std::to_string(chunk[0]) + " " + std::to_string(chunk[1]) + " " + std::to_string(chunk[2]),
        MaterialId{surface});
    mesh.mesh(points, indices);
  }
}

}  // namespace sightline::scenes::cave
