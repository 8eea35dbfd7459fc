#include "scenes/butte.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "scenes/noise.h"

namespace sightline::scenes {
namespace {

constexpr double kSunk = 6.0;                       // metres below the lowest ground
constexpr double kLedgePitch = 13.0, kLedge = 2.2;  // metres from ledge to ledge, and how deep one is
constexpr double kDome = 0.88;                      // part of the height from which the top is rounded

}  // namespace

Vec3d Butte::at(double turns, double part) const {
  const Point2 out = unitVector(turns);
  const double z = -kSunk + part * (height + kSunk);
  const Vec3d around(out.x * radius, out.y * radius, z);
  const double up = z / kLedgePitch + 0.5 * noise(around / 20.0, seed);
  const double level = std::floor(up), within = up - level;
  const double ledges = kLedge * (level + smoothStep(0.8, 1.0, within));
  const double rough = 0.2 * radius * fractalNoise(around / 17.0, 2, seed + 8) +
                       1.1 * fractalNoise(around / 4.5, 2, seed + 16);
  const double body = std::clamp(radius * 1.08 - ledges + rough, 0.35 * radius, 1.45 * radius);
  const double t = std::max(part - kDome, 0.0) / (1.0 - kDome);
  const double r = body * std::sqrt(std::max(1.0 - 0.97 * t * t, 0.0));
  return {middle.x + out.x * r, middle.y + out.y * r, foot + z};
}

Vec3d Butte::normal(double turns, double part) const {
  const double h = 0.5 / radius, v = 0.5 / height;
  const Vec3d around = at(turns + 0.16 * h, part) - at(turns - 0.16 * h, part);
  const Vec3d up = at(turns, std::min(part + v, 1.0)) - at(turns, part - v);
  return normalized(cross(around, up));
}

void addButte(MeshBuilder& mesh, const Butte& butte) {
  const auto corners = static_cast<std::uint32_t>(butte.radius * 3.2);
  const auto rings = static_cast<std::uint32_t>((butte.height + kSunk) / 2.0);
  std::vector<Vec3d> points;
  for (std::uint32_t ring = 0; ring <= rings; ++ring) {
    // Rings are closer together near the top, where the surface is flat.
    const double t = static_cast<double>(ring) / rings, part = t * (1.25 - 0.25 * t);
    for (std::uint32_t corner = 0; corner < corners; ++corner) {
      points.push_back(butte.at(static_cast<double>(corner) / corners, part));
    }
  }
  mesh.place({});
  mesh.tube(points, corners);
}

}  // namespace sightline::scenes
