// Rock towers in a wood of see-through leaves.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "scenes/butte.h"
#include "scenes/free_ground.h"
#include "scenes/height_field.h"
#include "scenes/landscapes.h"
#include "scenes/nature.h"
#include "scenes/noise.h"
#include "scenes/random.h"
#include "scenes/walk.h"

namespace sightline {
namespace scenes::jungle {
namespace {

constexpr double kHalfSize = 220.0;  // of the ground, metres
constexpr std::uint32_t kQuads = 140, kTiles = 14;
constexpr std::uint32_t kShrubs = 900, kBoulders = 500;
constexpr std::uint32_t kTreesOnButte = 14, kShrubsOnButte = 20;

// Indices into Scene::materials.
enum Surface : std::uint32_t { kSoil, kMoss, kRock, kRedRock, kStone, kBark, kCrown, kLeaves, kFern };

std::vector<Material> materials() {
  constexpr Opacity kOpaque = Opacity::kOpaque;
  constexpr Opacity kSeeThrough = Opacity::kAlphaTested;
  return {{"soil", kOpaque, false, {0.19f, 0.14f, 0.08f, 1.0f}},
          {"moss", kOpaque, false, {0.13f, 0.20f, 0.06f, 1.0f}},
          {"rock", kOpaque, false, {0.36f, 0.32f, 0.28f, 1.0f}},
          {"red rock", kOpaque, false, {0.44f, 0.30f, 0.21f, 1.0f}},
          {"stone", kOpaque, false, {0.30f, 0.29f, 0.27f, 1.0f}},
          {"bark", kOpaque, false, {0.18f, 0.12f, 0.08f, 1.0f}},
          {"crown", kOpaque, false, {0.08f, 0.22f, 0.05f, 1.0f}},
          {"leaves", kSeeThrough, true, {0.11f, 0.30f, 0.06f, 1.0f}},
          {"fern", kSeeThrough, true, {0.20f, 0.38f, 0.08f, 1.0f}}};
}

std::vector<Vec3d> route() {
  const std::vector<Vec3d> corners{{-190, -150, 0}, {-90, -110, 0}, {-60, -10, 0},
                                   {-140, 70, 0},   {-50, 150, 0},  {50, 100, 0},
                                   {40, 0, 0},      {110, -100, 0}, {190, -50, 0}};
  return roundedRoute(corners, 45.0);
}

HeightField ground(std::uint64_t seed) {
  return {{{-kHalfSize, -kHalfSize}, {kHalfSize, kHalfSize}}, kQuads, [&](Point2 p) {
            const double rim = smoothStep(0.8, 1.0, std::max(std::abs(p.x), std::abs(p.y)) / kHalfSize);
            return 30.0 * rim + 5.0 * noise(p / 90.0, 4 * seed) +
                   1.6 * fractalNoise(p / 28.0, 3, 4 * seed + 1);
          }};
}

class Wood {
 public:
  Wood(MeshBuilder& mesh, const HeightField& field, const JungleOptions& options)
      : mesh_(mesh), field_(field), options_(options), route_(route()) {
    free_.keepLine(route_, 1.5);
  }

  void build() {
    planButtes(Random(options_.seed, 1));
    for (std::size_t i = 0; i < buttes_.size(); ++i) {
      Random random(options_.seed, 100 + i);
      const std::string name = "butte " + std::to_string(i);
      mesh_.startObject(name, MaterialId{random.chance(0.5) ? kRock : kRedRock});
      addButte(mesh_, buttes_[i]);
      grow(buttes_[i], random, name);
    }
    boulders(Random(options_.seed, 2));
    trees(Random(options_.seed, 3));
    shrubs(Random(options_.seed, 4));
  }

 private:
  static Point2 anywhere(Random& random) {
    const double x = random.range(-kHalfSize, kHalfSize);
    return {x, random.range(-kHalfSize, kHalfSize)};
  }

  void planButtes(Random random) {
    for (std::uint32_t i = 0; i < 60 * options_.buttes && buttes_.size() < options_.buttes; ++i) {
      const Point2 at = anywhere(random);
      const double radius = random.range(9.0, 24.0), height = random.range(30.0, 75.0);
      const double apart = distanceToLine(at, route_);
      const bool at_edge = std::max(std::abs(at.x), std::abs(at.y)) + 1.2 * radius > kHalfSize;
      const bool near = std::any_of(buttes_.begin(), buttes_.end(), [&](const Butte& b) {
        return length(b.middle - at) < 1.05 * (b.radius + radius);
      });
      // Most stand along the walk.
      if (near || at_edge || apart < 1.5 * radius + 3.0 || (apart > 55.0 && random.chance(0.6))) {
        continue;
      }
      buttes_.push_back({at, radius, height, field_.lowest(at, radius), random.next()});
      free_.takeCircle(at, 1.1 * radius);
    }
  }

  TreeSurfaces surfaces() const {
    return {MaterialId{kBark}, MaterialId{kCrown}, MaterialId{kCrown}, MaterialId{kLeaves}};
  }
  void shrub(const Vec3d& at, double radius, Random& random, const std::string& name) {
    mesh_.place({});
    mesh_.startObject(name, MaterialId{kFern});
    addLeaves(mesh_, at + Vec3d(0, 0, 0.5 * radius), {radius, radius, 0.7 * radius}, 14, 0.8 * radius,
              random);
  }

  // Trees on ledges and on the top of a butte, and shrubs on its walls.
  void grow(const Butte& butte, Random& random, const std::string& name) {
    std::uint32_t tree = 0;
    for (std::uint32_t attempt = 0; attempt < 300 && tree < kTreesOnButte; ++attempt) {
      const double turns = random.uniform(), part = random.range(0.2, 0.99);
      const double height = random.range(4.0, 9.0);
      if (butte.normal(turns, part).z > 0.55) {
        addTree(mesh_, {butte.at(turns, part)}, TreeKind::kLeafy, height, surfaces(), random,
                name + " tree " + std::to_string(tree++));
      }
    }
    for (std::uint32_t i = 0; i < kShrubsOnButte; ++i) {
      const double turns = random.uniform(), part = random.range(0.25, 0.95);
      const double radius = random.range(0.6, 1.5);
      shrub(butte.at(turns, part) + butte.normal(turns, part) * (0.3 * radius), radius, random,
            name + " shrub " + std::to_string(i));
    }
  }

  void boulders(Random random) {
    std::uint32_t boulder = 0;
    for (std::uint32_t attempt = 0; attempt < 20 * kBoulders && boulder < kBoulders; ++attempt) {
      const Point2 at = anywhere(random);
      const double any = random.uniform(), radius = 0.4 + 2.4 * any * any * any;
      if (free_.tryCircle(at, 1.3 * radius)) {
        addStone(mesh_, {{at.x, at.y, field_.lowest(at, 0.5 * radius)}}, radius, MaterialId{kStone}, random,
                 "boulder " + std::to_string(boulder++));
      }
    }
  }

  void trees(Random random) {
    std::uint32_t tree = 0;
    for (std::uint32_t attempt = 0; attempt < 20 * options_.trees && tree < options_.trees; ++attempt) {
      const Point2 at = anywhere(random);
      const double height = random.range(9.0, 18.0);
      const TreeKind kind = random.chance(0.88) ? TreeKind::kLeafy : TreeKind::kBroadleaf;
      if (free_.tryCircle(at, 0.9)) {
        addTree(mesh_, {field_.point(at)}, kind, height, surfaces(), random,
                "tree " + std::to_string(tree++));
      }
    }
  }

  void shrubs(Random random) {
    std::uint32_t number = 0;
    for (std::uint32_t attempt = 0; attempt < 20 * kShrubs && number < kShrubs; ++attempt) {
      const Point2 at = anywhere(random);
      const double radius = random.range(0.4, 1.0);
      if (free_.tryCircle(at, radius)) {
        shrub(field_.point(at), radius, random, "shrub " + std::to_string(number++));
      }
    }
  }

  MeshBuilder& mesh_;
  const HeightField& field_;
  const JungleOptions& options_;
  std::vector<Vec3d> route_;
  FreeGround free_;
  std::vector<Butte> buttes_;
};

}  // namespace
}  // namespace scenes::jungle

Scene makeJungle(const JungleOptions& options) {
  using namespace scenes;
  Scene scene;
  scene.materials = jungle::materials();
  const HeightField field = jungle::ground(options.seed);
  {
    MeshBuilder mesh(scene);
    field.addTiles(mesh, jungle::kTiles, "ground", [&](Point2 p) {
      return MaterialId{noise(p / 40.0, options.seed) > 0.0 ? jungle::kMoss : jungle::kSoil};
    });
    jungle::Wood(mesh, field, options).build();
  }
  weldPositions(scene);
  updateBounds(scene);
  scene.paths = {walkAlong(
      overGround(field, jungle::route(), 1.7),
      {.name = "ground", .look_ahead = 6.0, .glance = 0.4, .glance_turns = 9, .calm = 3, .far = 1000.0})};
  return scene;
}

}  // namespace sightline
