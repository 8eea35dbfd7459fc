#include "scenes/cottage.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace sightline::scenes {
namespace {

constexpr double kWindowWidth = 0.9, kWindowHeight = 1.1, kSill = 0.95;
constexpr double kDoorWidth = 1.0, kDoorHeight = 2.05;
constexpr double kThickness = 0.18;  // of the roof, metres
constexpr double kOverhang = 0.45;

// Middles of the windows of a wall of this length.
std::vector<double> windowsOf(double length) {
  const auto count = static_cast<std::uint32_t>(length / 2.4);
  std::vector<double> middles;
  for (std::uint32_t i = 0; i < count; ++i) {
    middles.push_back(length * ((i + 0.5) / count - 0.5));
  }
  return middles;
}

std::vector<double> cutsBeside(double length, const std::vector<double>& windows) {
  std::vector<double> cuts{-0.5 * length};
  for (const double middle : windows) {
    cuts.push_back(middle - 0.5 * kWindowWidth);
    cuts.push_back(middle + 0.5 * kWindowWidth);
  }
  cuts.push_back(0.5 * length);
  return cuts;
}

WallCuts cutsOf(const Cottage& c) {
  WallCuts cuts{
      cutsBeside(c.length, windowsOf(c.length)), cutsBeside(c.width, windowsOf(c.width)), {-c.sunk, 0.0}};
  for (std::uint32_t storey = 0; storey < c.storeys; ++storey) {
    cuts.zs.push_back(storey * c.storey + kSill);
    cuts.zs.push_back(storey * c.storey + kSill + kWindowHeight);
  }
  cuts.zs.push_back(c.eaves());
  return cuts;
}

// Calls visit(placement) for every window but the one in the door's place; the placement's origin is the
// middle of the sill, x along the wall, y up, z outwards.
template <typename Visit>
void forEachWindow(const Placement& house, const Cottage& c, const Visit& visit) {
  const std::array<Point2, 4> outline{{{-0.5 * c.length, -0.5 * c.width},
                                       {0.5 * c.length, -0.5 * c.width},
                                       {0.5 * c.length, 0.5 * c.width},
                                       {-0.5 * c.length, 0.5 * c.width}}};
  for (std::size_t side = 0; side < 4; ++side) {
    const Point2 a = outline[side], b = outline[(side + 1) % 4];
    for (std::uint32_t storey = 0; storey < c.storeys; ++storey) {
      const Placement wall = house.onWall(a, b, storey * c.storey + kSill);
      for (const double middle : windowsOf(length(b - a))) {
        const bool at_door = side == 0 && storey == 0 && std::abs(middle) < kDoorWidth + 0.3;
        if (!at_door) {
          visit(wall.moved({middle + 0.5 * length(b - a), 0.0, 0.0}));
        }
      }
    }
  }
}

void addOpenings(MeshBuilder& mesh, const Placement& placement, const Cottage& c, const std::string& name) {
  mesh.startObject(name + " windows", c.surfaces.window);
  forEachWindow(placement, c, [&](const Placement& sill) {
    mesh.place(sill);
    mesh.box({-0.5 * kWindowWidth, 0.0, -0.05}, {0.5 * kWindowWidth, kWindowHeight, 0.04});
  });
  mesh.startObject(name + " shutters", c.surfaces.wood);
  forEachWindow(placement, c, [&](const Placement& sill) {
    mesh.place(sill);
    for (const double side : {-1.0, 1.0}) {
      const double middle = side * 0.76 * kWindowWidth;
      mesh.box({middle - 0.2, -0.03, -0.02}, {middle + 0.2, kWindowHeight + 0.03, 0.06});
    }
  });
  mesh.place(placement);
  mesh.startObject(name + " door", c.surfaces.wood);
  mesh.box({-0.5 * kDoorWidth, -0.5 * c.width - 0.05, 0.0},
           {0.5 * kDoorWidth, -0.5 * c.width + 0.05, kDoorHeight});
  mesh.startObject(name + " doorstep", c.surfaces.stone);
  mesh.box({-0.8, -0.5 * c.width - 0.7, -c.sunk}, {0.8, -0.5 * c.width - 0.02, -0.02});
}

}  // namespace

void addRoofSlabs(MeshBuilder& mesh, double length, double width, double z, double pitch,
                  std::uint32_t pieces) {
  const double half = 0.5 * width + kOverhang, drop = kOverhang * pitch, top = z + 0.5 * width * pitch;
  // A section across the ridge, counter-clockwise as seen from the east end.
  const std::array<Point2, 6> section{{{-half, z - drop},
                                       {0.0, top},
                                       {half, z - drop},
                                       {half, z - drop + kThickness},
                                       {0.0, top + kThickness},
                                       {-half, z - drop + kThickness}}};
  const double end = 0.5 * length + kOverhang;
  const auto at = [&](std::uint32_t piece, std::size_t corner) {
    return Vec3d(end * (2.0 * piece / pieces - 1.0), section[corner].x, section[corner].y);
  };
  for (std::uint32_t p = 0; p < pieces; ++p) {
    for (std::size_t i = 0; i < 6; ++i) {
      const std::size_t k = (i + 1) % 6;
      mesh.quad(at(p, i), at(p, k), at(p + 1, k), at(p + 1, i));
    }
  }
  // The ends are two parallelograms each.
  const auto close = [&](std::uint32_t p, std::size_t a, std::size_t b, std::size_t c, std::size_t d) {
    mesh.quad(at(p, a), at(p, b), at(p, c), at(p, d));
  };
  close(pieces, 0, 1, 4, 5);
  close(pieces, 1, 2, 3, 4);
  close(0, 5, 4, 1, 0);
  close(0, 4, 3, 2, 1);
}

void addGabledWalls(MeshBuilder& mesh, const WallCuts& cuts, double pitch) {
  const auto& [xs, ys, zs] = cuts;
  const double half = ys.back(), eaves = zs.back(), ridge = eaves + half * pitch;
  for (std::size_t i = 0; i + 1 < xs.size(); ++i) {
    for (std::size_t k = 0; k + 1 < zs.size(); ++k) {
      mesh.quad({xs[i], -half, zs[k]}, {xs[i + 1], -half, zs[k]}, {xs[i + 1], -half, zs[k + 1]},
                {xs[i], -half, zs[k + 1]});
      mesh.quad({xs[i + 1], half, zs[k]}, {xs[i], half, zs[k]}, {xs[i], half, zs[k + 1]},
                {xs[i + 1], half, zs[k + 1]});
    }
    for (std::size_t k = 0; k + 1 < ys.size(); ++k) {
      mesh.quad({xs[i], ys[k], zs[0]}, {xs[i], ys[k + 1], zs[0]}, {xs[i + 1], ys[k + 1], zs[0]},
                {xs[i + 1], ys[k], zs[0]});
    }
    mesh.quad({xs[i], -half, eaves}, {xs[i + 1], -half, eaves}, {xs[i + 1], 0, ridge}, {xs[i], 0, ridge});
    mesh.quad({xs[i + 1], half, eaves}, {xs[i], half, eaves}, {xs[i], 0, ridge}, {xs[i + 1], 0, ridge});
  }
  const double west = xs.front(), east = xs.back();
  for (std::size_t i = 0; i + 1 < ys.size(); ++i) {
    for (std::size_t k = 0; k + 1 < zs.size(); ++k) {
      mesh.quad({east, ys[i], zs[k]}, {east, ys[i + 1], zs[k]}, {east, ys[i + 1], zs[k + 1]},
                {east, ys[i], zs[k + 1]});
      mesh.quad({west, ys[i + 1], zs[k]}, {west, ys[i], zs[k]}, {west, ys[i], zs[k + 1]},
                {west, ys[i + 1], zs[k + 1]});
    }
    mesh.triangle({east, ys[i], eaves}, {east, ys[i + 1], eaves}, {east, 0, ridge});
    mesh.triangle({west, ys[i + 1], eaves}, {west, ys[i], eaves}, {west, 0, ridge});
  }
}

void addCottage(MeshBuilder& mesh, const Placement& placement, const Cottage& c, Random& random,
                const std::string& name) {
  mesh.place(placement);
  mesh.startObject(name + " walls", c.surfaces.wall);
  addGabledWalls(mesh, cutsOf(c), c.pitch);
  mesh.startObject(name + " roof", c.surfaces.roof);
  // A gap keeps the roof's underside off the top of the walls.
  addRoofSlabs(mesh, c.length, c.width, c.eaves() + 0.03, c.pitch, 4);
  const double along = random.range(-0.3, 0.3) * c.length;
  const double across = random.chance(0.5) ? 0.22 * c.width : -0.22 * c.width;
  mesh.startObject(name + " chimney", c.surfaces.stone);
  mesh.box({along - 0.35, across - 0.35, c.eaves()}, {along + 0.35, across + 0.35, c.ridge() + 0.9});
  addOpenings(mesh, placement, c, name);
}

}  // namespace sightline::scenes
