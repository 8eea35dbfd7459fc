// Mountains with a winding valley, and what stands on them.

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "scenes/cottage.h"
#include "scenes/free_ground.h"
#include "scenes/height_field.h"
#include "scenes/landscapes.h"
#include "scenes/nature.h"
#include "scenes/noise.h"
#include "scenes/random.h"
#include "scenes/walk.h"

namespace sightline {
namespace scenes::terrain {
namespace {

constexpr double kSize = 1200.0;  // side of the terrain, which is centred on the origin; metres
constexpr std::uint32_t kTiles = 16;
constexpr double kEyeHeight = 1.7;
constexpr std::uint32_t kHuts = 40, kTrees = 1400, kStones = 700;
constexpr Rectangle kArea{{-0.5 * kSize, -0.5 * kSize}, {0.5 * kSize, 0.5 * kSize}};

// Indices into Scene::materials.
enum Surface : std::uint32_t {
  kMeadow,
  kRock,
  kPaleRock,
  kSnow,
  kStone,
  kBark,
  kNeedles,
  kCrown,
  kLeaves,
  kLogs,
  kShingles,
  kMasonry,
  kWood,
  kWindow
};

std::vector<Material> materials() {
  constexpr Opacity kOpaque = Opacity::kOpaque;
  return {{"meadow", kOpaque, false, {0.16f, 0.24f, 0.07f, 1.0f}},
          {"rock", kOpaque, false, {0.27f, 0.25f, 0.22f, 1.0f}},
          {"pale rock", kOpaque, false, {0.38f, 0.36f, 0.33f, 1.0f}},
          {"snow", kOpaque, false, {0.80f, 0.82f, 0.86f, 1.0f}},
          {"stone", kOpaque, false, {0.34f, 0.33f, 0.31f, 1.0f}},
          {"bark", kOpaque, false, {0.16f, 0.11f, 0.07f, 1.0f}},
          {"needles", kOpaque, false, {0.05f, 0.14f, 0.06f, 1.0f}},
          {"crown", kOpaque, false, {0.12f, 0.26f, 0.06f, 1.0f}},
          {"leaves", Opacity::kAlphaTested, true, {0.24f, 0.34f, 0.08f, 1.0f}},
          {"logs", kOpaque, false, {0.31f, 0.18f, 0.09f, 1.0f}},
          {"shingles", kOpaque, false, {0.20f, 0.15f, 0.12f, 1.0f}},
          {"masonry", kOpaque, false, {0.42f, 0.40f, 0.36f, 1.0f}},
          {"wood", kOpaque, false, {0.24f, 0.13f, 0.06f, 1.0f}},
          {"window", kOpaque, false, {0.09f, 0.14f, 0.20f, 1.0f}}};
}

// The line along which the valley's floor winds, from south-west to north-east.
std::vector<Vec3d> valleyLine(Random random) {
  static constexpr Point2 kCorners[] = {{-640, -330}, {-430, -330}, {-300, -110}, {-380, 120},
                                        {-190, 270},  {20, 130},    {-30, -110},  {140, -290},
                                        {350, -170},  {290, 90},    {420, 270},   {640, 290}};
  std::vector<Vec3d> corners;
  for (const Point2 corner : kCorners) {
    const double x = corner.x + random.range(-25.0, 25.0);
    corners.emplace_back(x, corner.y + random.range(-25.0, 25.0), 0.0);
  }
  return roundedRoute(corners, 90.0);
}

// What a slope that rises evenly lacks to steps with steep faces, by its height.
double cliffs(double height) {
  constexpr double kStep = 34.0;
  const double part = height / kStep - std::floor(height / kStep);
  return kStep * 0.85 * (smoothStep(0.62, 0.9, part) - part);
}

HeightField ground(const TerrainOptions& options, const std::vector<Vec3d>& valley) {
  const std::uint64_t seed = std::uint64_t{options.seed} * 64;
  const auto height = [&](Point2 p) {
    const Point2 bend{12.0 * fractalNoise(p / 70.0, 2, seed), 12.0 * fractalNoise(p / 70.0, 2, seed + 8)};
    const double away = distanceToLine(p + bend, valley);
    const double rise = smoothStep(22.0, 125.0, away);
    const double rock =
        45.0 + 190.0 * ridgedNoise(p / 260.0, 5, seed + 16) + 26.0 * fractalNoise(p / 55.0, 4, seed + 24);
    // Layers of hard rock slope and wave, so that their cliffs are at any height.
    const double layers = rise * rock + 22.0 * noise(p / 110.0, seed + 48);
    const double hardness = 0.9 * smoothStep(-0.1, 0.25, noise(p / 120.0, seed + 32));
    return rise * rock + cliffs(layers) * hardness * smoothStep(0.0, 0.1, rise) +
           1.2 * fractalNoise(p / 30.0, 3, seed + 40) * (1.0 + 3.0 * rise);
  };
  const auto quads = static_cast<std::uint32_t>(std::sqrt(options.triangles / 2.0) + 0.5);
  return {kArea, quads, height};
}

MaterialId surfaceOf(const HeightField& field, Point2 middle) {
  constexpr double kStep = kSize / kTiles / 5.0;
  double height = 0.0, slope = 0.0;
  int floor = 0;
  for (int i = -2; i <= 2; ++i) {
    for (int k = -2; k <= 2; ++k) {
      const Point2 p = middle + Point2{i * kStep, k * kStep};
      height += field.height(p) / 25.0;
      slope += field.slope(p, 8.0) / 25.0;
      floor += field.height(p) < 8.0 ? 1 : 0;
    }
  }
  return MaterialId{floor > 4 ? kMeadow : height > 150.0 ? kSnow : slope > 1.1 ? kPaleRock : kRock};
}

class Things {
 public:
  Things(MeshBuilder& mesh, const HeightField& field, const std::vector<Vec3d>& valley, std::uint64_t seed)
      : mesh_(mesh), field_(field), valley_(valley), seed_(seed) {
    free_.keepLine(valley, 3.0);
  }

  void build() {
    huts(Random(seed_, 2));
    trees(Random(seed_, 3));
    stones(Random(seed_, 4));
  }

 private:
  // A place up to `reach` metres beside the valley's line, within the terrain.
  Point2 besideValley(Random& random, double reach) const {
    Point2 p;
    do {
      const std::uint32_t leg = random.below(static_cast<std::uint32_t>(valley_.size()) - 1);
      const double along = random.uniform(), aside = random.range(-reach, reach);
      const Vec3d d = valley_[leg + 1] - valley_[leg], at = valley_[leg] + d * along;
      const Point2 across = Point2{-d.y, d.x} / length(d);
      p = Point2{at.x, at.y} + across * aside;
    } while (!kArea.contains(p));
    return p;
  }

  void huts(Random random) {
    std::uint32_t hut = 0;
    for (std::uint32_t attempt = 0; attempt < 40 * kHuts && hut < kHuts; ++attempt) {
      const Point2 at = besideValley(random, 34.0);
      const Point2 along = unitVector(random.uniform());
      Cottage plan{.surfaces = {MaterialId{kLogs}, MaterialId{kShingles}, MaterialId{kMasonry},
                                MaterialId{kWood}, MaterialId{kWindow}}};
      plan.length = random.range(6.5, 10.0);
      plan.width = random.range(5.0, 7.0);
      if (field_.slope(at, 6.0) > 0.3 ||
          !free_.tryFootprint({at, along, 0.5 * plan.length + 1.5, 0.5 * plan.width + 2.0})) {
        continue;
      }
      const double low = field_.lowest(at, 6.0), floor = 0.5 * (low + field_.highest(at, 6.0)) + 0.1;
      plan.sunk = floor - low + 1.0;
      const Placement place{{at.x, at.y, floor}, {along.x, along.y, 0}, {-along.y, along.x, 0}, {0, 0, 1}};
      addCottage(mesh_, place, plan, random, "hut " + std::to_string(hut++));
    }
  }

  void trees(Random random) {
    const TreeSurfaces surfaces{MaterialId{kBark}, MaterialId{kNeedles}, MaterialId{kCrown},
                                MaterialId{kLeaves}};
    std::uint32_t tree = 0;
    for (std::uint32_t attempt = 0; attempt < 30 * kTrees && tree < kTrees; ++attempt) {
      const Point2 at = besideValley(random, 120.0);
      const double height = random.range(7.0, 15.0), any = random.uniform();
      const TreeKind kind = any < 0.6   ? TreeKind::kConifer
                            : any < 0.9 ? TreeKind::kBroadleaf
                                        : TreeKind::kLeafy;
      const bool in_wood = noise(at / 60.0, seed_ + 50) > random.range(-0.35, 0.25);
      if (in_wood && field_.height(at) < 110.0 && field_.slope(at) < 0.8 &&
          free_.tryCircle(at, 0.75 * crownRadius(kind, height))) {
        addTree(mesh_, {{at.x, at.y, field_.height(at)}}, kind, height, surfaces, random,
                "tree " + std::to_string(tree++));
      }
    }
  }

  void stones(Random random) {
    std::uint32_t stone = 0;
    for (std::uint32_t attempt = 0; attempt < 20 * kStones && stone < kStones; ++attempt) {
      const Point2 at = besideValley(random, 90.0);
      const double any = random.uniform(), radius = 0.4 + 2.6 * any * any * any;
      if (field_.slope(at) < 1.0 && free_.tryCircle(at, radius * 1.1)) {
        addStone(mesh_, {{at.x, at.y, field_.lowest(at, radius * 0.5)}}, radius, MaterialId{kStone}, random,
                 "stone " + std::to_string(stone++));
      }
    }
  }

  MeshBuilder& mesh_;
  const HeightField& field_;
  const std::vector<Vec3d>& valley_;
  std::uint64_t seed_;
  FreeGround free_;
};

CameraPath walk(const HeightField& field, const std::vector<Vec3d>& valley) {
  constexpr std::size_t kSteps = 1600;  // of at most half a metre
  const std::vector<Vec3d> whole = overGround(field, valley, kEyeHeight);
  const std::size_t steps = std::min(kSteps, whole.size() / 2), first = (whole.size() - steps) / 3;
  const WalkOptions options{
      .name = "valley", .look_ahead = 12.0, .glance = 0.35, .glance_turns = 9, .calm = 3, .far = 2500.0};
  return walkAlong(std::span(whole).subspan(first, steps), options);
}

}  // namespace
}  // namespace scenes::terrain

Scene makeTerrain(const TerrainOptions& options) {
  using namespace scenes;
  Scene scene;
  scene.materials = terrain::materials();
  const std::vector<Vec3d> valley = terrain::valleyLine(Random(options.seed, 1));
  const HeightField field = terrain::ground(options, valley);
  {
    MeshBuilder mesh(scene);
    field.addTiles(mesh, terrain::kTiles, "ground", [&](Point2 p) { return terrain::surfaceOf(field, p); });
    terrain::Things(mesh, field, valley, options.seed).build();
  }
  weldPositions(scene);
  updateBounds(scene);
  scene.paths = {terrain::walk(field, valley)};
  return scene;
}

}  // namespace sightline
