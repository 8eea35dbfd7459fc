#include "scenes/plant.h"

#include <array>

namespace sightline::scenes {
namespace {

constexpr std::uint32_t kStems = 5, kLeaves = 61;
constexpr double kSoil = 0.26;

struct Stem {
  Vec3d foot, bend, tip;
  Vec3d at(double t) const {
    return t < 0.5 ? foot + (bend - foot) * (2 * t) : bend + (tip - bend) * (2 * t - 1);
  }
};

Vec3d across(Point2 direction, double r, double z) {
  return {direction.x * r, direction.y * r, z};
}

Stem anyStem(std::uint32_t number, Random& random) {
  const Point2 d = unitVector((number + random.uniform() * 0.7) / kStems);
  const double height = random.range(0.55, 0.95);
  return {across(d, 0.05, kSoil), across(d, random.range(0.06, 0.1), kSoil + height * 0.5),
          across(d, random.range(0.1, 0.17), kSoil + height)};
}

// Four sides up to the bend, four more up to the tip: 12 triangles.
void addStem(MeshBuilder& mesh, const Stem& stem) {
  constexpr double kRadius = 0.008;
  for (std::uint32_t i = 0; i < 4; ++i) {
    const Point2 a = unitVector(i * 0.25), b = unitVector((i + 1) * 0.25);
    const Vec3d low_a = stem.foot + across(a, kRadius, 0), low_b = stem.foot + across(b, kRadius, 0);
    const Vec3d mid_a = stem.bend + across(a, kRadius * 0.7, 0),
                mid_b = stem.bend + across(b, kRadius * 0.7, 0);
    mesh.quad(low_a, low_b, mid_b, mid_a);
    mesh.triangle(mid_a, mid_b, stem.tip);
  }
}

// A sheet with a folded midrib that droops towards its tip: 8 triangles.
void addLeaf(MeshBuilder& mesh, const Vec3d& root, Point2 direction, double reach, double lift) {
  const Point2 side{-direction.y, direction.x};
  const double half = reach * 0.28;
  const Vec3d rib1 = root + across(direction, reach * 0.35, lift * 0.8);
  const Vec3d rib2 = root + across(direction, reach * 0.7, lift);
  const Vec3d tip = root + across(direction, reach, lift * 0.6);
  const Vec3d left1 = rib1 + across(side, half, half * 0.3), right1 = rib1 - across(side, half, -half * 0.3);
  const Vec3d left2 = rib2 + across(side, half * 0.8, half * 0.2),
              right2 = rib2 - across(side, half * 0.8, -half * 0.2);
  mesh.triangle(root, rib1, left1);
  mesh.triangle(root, right1, rib1);
  mesh.quad(left1, rib1, rib2, left2);
  mesh.quad(rib1, right1, right2, rib2);
  mesh.triangle(left2, rib2, tip);
  mesh.triangle(rib2, right2, tip);
}

}  // namespace

void addPlant(MeshBuilder& mesh, const Placement& placement, Random random) {
  mesh.place(placement.turned(random.uniform()));
  mesh.lathe(std::array<Point2, 6>{{{0, 0}, {0.12, 0}, {0.17, 0.3}, {0.15, 0.3}, {0.14, kSoil}, {0, kSoil}}},
             12);
  std::array<Stem, kStems> stems;
  for (std::uint32_t i = 0; i < kStems; ++i) {
    stems[i] = anyStem(i, random);
    addStem(mesh, stems[i]);
  }
  for (std::uint32_t i = 0; i < kLeaves; ++i) {
    const Vec3d root = stems[i % kStems].at(random.range(0.35, 1.0));
    const Point2 direction = unitVector(random.uniform());
    const double reach = random.range(0.13, 0.23), lift = random.range(-0.02, 0.08);
    addLeaf(mesh, root, direction, reach, lift);
  }
}

}  // namespace sightline::scenes
