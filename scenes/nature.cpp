#include "scenes/nature.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "scenes/noise.h"

namespace sightline::scenes {
namespace {

struct Sphere {
  std::vector<Vec3d> points;  // unit vectors
  std::vector<std::uint32_t> indices;
};

Sphere icosahedron() {
  const double g = (1.0 + std::sqrt(5.0)) * 0.5;
  Sphere sphere{
      {{-1, g, 0},
       {1, g, 0},
       {-1, -g, 0},
       {1, -g, 0},
       {0, -1, g},
       {0, 1, g},
       {0, -1, -g},
       {0, 1, -g},
       {g, 0, -1},
       {g, 0, 1},
       {-g, 0, -1},
       {-g, 0, 1}},
      {0, 11, 5, 0, 5, 1, 0, 1, 7, 0, 7, 10, 0, 10, 11, 1, 5, 9, 5, 11, 4,  11, 10, 2,  10, 7, 6, 7, 1, 8,
       3, 9,  4, 3, 4, 2, 3, 2, 6, 3, 6, 8,  3, 8,  9,  4, 9, 5, 2, 4,  11, 6,  2,  10, 8,  6, 7, 9, 8, 1}};
  for (Vec3d& point : sphere.points) {
    point = normalized(point);
  }
  return sphere;
}

// Each triangle becomes four.
Sphere refined(const Sphere& coarse) {
  Sphere fine{coarse.points, {}};
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [at, is_new] =
        middles.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<std::uint32_t>(fine.points.size()));
    if (is_new) {
      fine.points.push_back(normalized(fine.points[a] + fine.points[b]));
    }
    return at->second;
  };
  for (std::size_t i = 0; i < coarse.indices.size(); i += 3) {
    const std::uint32_t a = coarse.indices[i], b = coarse.indices[i + 1], c = coarse.indices[i + 2];
    const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    fine.indices.insert(fine.indices.end(), {a, ab, ca, b, bc, ab, c, ca, bc, ab, bc, ca});
  }
  return fine;
}

const Sphere& sphereOf(std::uint32_t level) {
  static const std::array<Sphere, 4> kSpheres = [] {
    std::array<Sphere, 4> spheres{icosahedron()};
    for (std::size_t i = 1; i < spheres.size(); ++i) {
      spheres[i] = refined(spheres[i - 1]);
    }
    return spheres;
  }();
  return kSpheres[std::min<std::size_t>(level, 3)];
}

Vec3d anyDirection(Random& random) {
  Vec3d d;
  do {
    const double x = random.range(-1, 1), y = random.range(-1, 1), z = random.range(-1, 1);
    d = {x, y, z};
  } while (dot(d, d) > 1.0 || dot(d, d) < 0.01);
  return normalized(d);
}

Vec3d scaled(const Vec3d& p, const Vec3d& by) {
  return {p.x * by.x, p.y * by.y, p.z * by.z};
}

void addTrunk(MeshBuilder& mesh, double height, double radius) {
  const Point2 profile[] = {
      {0.0, -1.2}, {radius * 1.25, -1.2}, {radius, 0.4}, {radius * 0.55, height}, {0.0, height}};
  mesh.lathe(profile, 7);
}

void addConiferCrown(MeshBuilder& mesh, double low, double high, double radius) {
  constexpr int kTiers = 4;
  std::vector<Point2> profile{{0.0, low + 0.1}};
  for (int i = 0; i < kTiers; ++i) {
    const double t = static_cast<double>(i) / kTiers, next = (i + 1.0) / kTiers;
    profile.push_back({radius * (1.0 - t * 0.85), low + (high - low) * t * 0.9});
    if (i + 1 < kTiers) {
      profile.push_back({radius * (1.0 - next * 0.85) * 0.55, low + (high - low) * next * 0.9 + 0.25});
    }
  }
  profile.push_back({0.0, high});
  mesh.lathe(profile, 9);
}

void addBroadleafCrown(MeshBuilder& mesh, double low, double high, double radius, Random& random) {
  const Vec3d middle(0, 0, (low + high) * 0.5);
  addBlob(mesh, middle, {radius, radius, (high - low) * 0.5}, 0.25, 2, random.next());
  const double turns = random.uniform();
  for (int i = 0; i < 2; ++i) {
    const Point2 d = unitVector(turns + 0.45 * i) * (radius * 0.6);
    const double r = radius * random.range(0.5, 0.65);
    addBlob(mesh, middle + Vec3d(d.x, d.y, (0.15 - 0.3 * i) * (high - low)), {r, r, r * 0.8}, 0.3, 1,
            random.next());
  }
}

}  // namespace

void addBlob(MeshBuilder& mesh, const Vec3d& middle, const Vec3d& radii, double rough, std::uint32_t level,
             std::uint64_t seed) {
  const Sphere& sphere = sphereOf(level);
  std::vector<Vec3d> points;
  points.reserve(sphere.points.size());
  for (const Vec3d& direction : sphere.points) {
    const double out = 1.0 + rough * fractalNoise(direction * 1.7 + Vec3d(0.3, 0.4, 0.2), 2, seed);
    points.push_back(middle + scaled(direction, radii) * out);
  }
  mesh.mesh(points, sphere.indices);
}

void addLeaves(MeshBuilder& mesh, const Vec3d& middle, const Vec3d& radii, std::uint32_t count, double side,
               Random& random) {
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3d out = anyDirection(random);
    const Vec3d x = normalized(cross(out, anyDirection(random) + Vec3d(0.001, 0.002, 0.003)));
    // Leaves lean outwards.
    const Vec3d y = normalized(cross(out, x) + out * random.range(0.2, 1.2));
    const double half = 0.5 * side * random.range(0.7, 1.3);
    const Vec3d at = middle + scaled(out, radii) * random.range(0.6, 1.0);
    mesh.quad(at - x * half - y * half, at + x * half - y * half, at + x * half + y * half,
              at - x * half + y * half);
  }
}

double crownRadius(TreeKind kind, double height) {
  return height * (kind == TreeKind::kConifer ? 0.19 : kind == TreeKind::kBroadleaf ? 0.34 : 0.3);
}

double crownBase(TreeKind kind, double height) {
  return height * (kind == TreeKind::kConifer ? 0.14 : kind == TreeKind::kBroadleaf ? 0.32 : 0.45);
}

void addTree(MeshBuilder& mesh, const Placement& foot, TreeKind kind, double height,
             const TreeSurfaces& surfaces, Random& random, const std::string& name) {
  const double radius = crownRadius(kind, height), low = crownBase(kind, height);
  mesh.place(foot.turned(random.uniform()));
  mesh.startObject(name + " trunk", surfaces.bark);
  addTrunk(mesh, (low + height) * 0.5, 0.02 * height + 0.05);
  switch (kind) {
    case TreeKind::kConifer:
      mesh.startObject(name + " crown", surfaces.needles);
      return addConiferCrown(mesh, low, height, radius);
    case TreeKind::kBroadleaf:
      mesh.startObject(name + " crown", surfaces.crown);
      return addBroadleafCrown(mesh, low, height, radius, random);
    case TreeKind::kLeafy:
      mesh.startObject(name + " leaves", surfaces.leaves);
      return addLeaves(mesh, {0, 0, (low + height) * 0.5}, {radius, radius, (height - low) * 0.45}, 36,
                       0.55 * radius, random);
  }
}

void addStone(MeshBuilder& mesh, const Placement& foot, double radius, MaterialId material, Random& random,
              const std::string& name) {
  mesh.place(foot.turned(random.uniform()));
  mesh.startObject(name, material);
  const double length = radius * random.range(0.8, 1.2), width = radius * random.range(0.6, 1.0);
  const double height = radius * random.range(0.5, 0.9);
  addBlob(mesh, {0, 0, height * 0.4}, {length, width, height}, 0.5, radius > 1.0 ? 2 : 1, random.next());
}

}  // namespace sightline::scenes
