// Caverns of cubes, whose faces are merged to rectangles.

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "scenes/cave_parts.h"
#include "scenes/free_ground.h"
#include "scenes/landscapes.h"
#include "scenes/noise.h"
#include "scenes/walk.h"

namespace sightline {
namespace scenes::voxels {
namespace {

constexpr std::uint32_t kChunk = 16;  // cubes along the side of a chunk
constexpr double kWalkRoom = 1.1;     // around the walk no cube is left, metres
constexpr double kThingsFromWalk = 1.5;

// Indices into Scene::materials. Cubes are of the first three; kAir is none.
enum Kind : std::uint8_t { kStone, kSlate, kOre, kCrate, kLamp, kAir };

std::vector<Material> materials() {
  constexpr Opacity kOpaque = Opacity::kOpaque;
  return {{"stone", kOpaque, false, {0.40f, 0.40f, 0.42f, 1.0f}},
          {"slate", kOpaque, false, {0.28f, 0.30f, 0.34f, 1.0f}},
          {"ore", kOpaque, false, {0.50f, 0.36f, 0.16f, 1.0f}},
          {"crate", kOpaque, false, {0.40f, 0.24f, 0.10f, 1.0f}},
          {"lamp", kOpaque, false, {0.95f, 0.75f, 0.30f, 1.0f}}};
}

// Cubes of 1 m. The cube (x, y, z) of the grid is centred at the grid's point of that number, and its corners
// have whole coordinates.
class Cubes {
 public:
  Cubes(const ValueGrid& grid, std::uint64_t seed) : grid_(grid), kinds_(grid.values.size(), kAir) {
    forEach([&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
      const std::size_t i = grid.index(x, y, z);
      if (grid.values[i] > 0.0f) {
        const Vec3d at = grid.point(x, y, z);
        kinds_[i] = fractalNoise(at / 6.0, 2, seed) > 0.35     ? kOre
                    : fractalNoise(at / 23.0, 2, seed + 1) > 0 ? kSlate
                                                               : kStone;
      }
    });
  }

  template <typename Body>
  void forEach(const Body& body) const {
    for (std::uint32_t z = 0; z < grid_.points[2]; ++z) {
      for (std::uint32_t y = 0; y < grid_.points[1]; ++y) {
        for (std::uint32_t x = 0; x < grid_.points[0]; ++x) {
          body(x, y, z);
        }
      }
    }
  }
  // The kind of the cube; outside the grid, stone.
  Kind at(const std::array<int, 3>& cube) const {
    for (int axis = 0; axis < 3; ++axis) {
      if (cube[axis] < 0 || cube[axis] >= static_cast<int>(grid_.points[axis])) {
        return kStone;
      }
    }
    return static_cast<Kind>(
        kinds_[grid_.index(static_cast<std::uint32_t>(cube[0]), static_cast<std::uint32_t>(cube[1]),
                           static_cast<std::uint32_t>(cube[2]))]);
  }
  // The corner of the cube with the least coordinates.
  Vec3d corner(const std::array<int, 3>& cube) const {
    return grid_.origin + Vec3d(cube[0] - 0.5, cube[1] - 0.5, cube[2] - 0.5);
  }
  const ValueGrid& grid() const { return grid_; }

 private:
  const ValueGrid& grid_;
  std::vector<std::uint8_t> kinds_;
};

// Adds the faces of one kind of cubes in a chunk that face air: the largest rectangles, one after the other.
class ChunkMesh {
 public:
  ChunkMesh(MeshBuilder& mesh, const Cubes& cubes, const std::array<int, 3>& first, Kind kind)
      : mesh_(mesh), cubes_(cubes), first_(first), kind_(kind) {}

  void add() {
    for (int axis = 0; axis < 3; ++axis) {
      for (const int side : {-1, 1}) {
        for (std::uint32_t layer = 0; layer < kChunk; ++layer) {
          addLayer(axis, side, static_cast<int>(layer));
        }
      }
    }
  }

 private:
  static constexpr int kSide = static_cast<int>(kChunk);

  void addLayer(int axis, int side, int layer) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    std::array<bool, kChunk * kChunk> shown{};
    for (int j = 0; j < kSide; ++j) {
      for (int i = 0; i < kSide; ++i) {
        std::array<int, 3> cube = first_;
        cube[axis] += layer;
        cube[u] += i;
        cube[v] += j;
        const bool is_of_kind = cubes_.at(cube) == kind_;
        cube[axis] += side;
        shown[static_cast<std::size_t>(j * kSide + i)] = is_of_kind && cubes_.at(cube) == kAir;
      }
    }
    const auto is = [&](int i, int j) -> bool& { return shown[static_cast<std::size_t>(j * kSide + i)]; };
    for (int j = 0; j < kSide; ++j) {
      for (int i = 0; i < kSide; ++i) {
        if (!is(i, j)) {
          continue;
        }
        int width = 1, height = 1;
        while (i + width < kSide && is(i + width, j)) {
          ++width;
        }
        const auto row_is_shown = [&](int row) {
          for (int k = 0; k < width; ++k) {
            if (!is(i + k, row)) {
              return false;
            }
          }
          return true;
        };
        while (j + height < kSide && row_is_shown(j + height)) {
          ++height;
        }
        for (int row = j; row < j + height; ++row) {
          for (int k = 0; k < width; ++k) {
            is(i + k, row) = false;
          }
        }
        addRectangle(axis, side, layer, {i, j}, {i + width, j + height});
      }
    }
  }

  void addRectangle(int axis, int side, int layer, std::array<int, 2> low, std::array<int, 2> high) {
    const auto corner = [&](int i, int j) {
      std::array<int, 3> cube = first_;
      cube[axis] += layer + (side > 0 ? 1 : 0);
      cube[(axis + 1) % 3] += i;
      cube[(axis + 2) % 3] += j;
      return cubes_.corner(cube);
    };
    const Vec3d a = corner(low[0], low[1]), b = corner(high[0], low[1]), c = corner(high[0], high[1]),
                d = corner(low[0], high[1]);
    side > 0 ? mesh_.quad(a, b, c, d) : mesh_.quad(a, d, c, b);
  }

  MeshBuilder& mesh_;
  const Cubes& cubes_;
  std::array<int, 3> first_;
  Kind kind_;
};

void addCubes(MeshBuilder& mesh, const Cubes& cubes) {
  mesh.place({});
  std::array<int, 3> chunks{};
  for (int axis = 0; axis < 3; ++axis) {
    chunks[axis] = static_cast<int>((cubes.grid().points[axis] + kChunk - 1) / kChunk);
  }
  constexpr std::array<const char*, 3> kNames{"rock stone ", "rock slate ", "rock ore "};
  for (int z = 0; z < chunks[2]; ++z) {
    for (int y = 0; y < chunks[1]; ++y) {
      for (int x = 0; x < chunks[0]; ++x) {
        for (const Kind kind : {kStone, kSlate, kOre}) {
          mesh.startObject(std::string(kNames[kind]) + std::to_string(x) + " " + std::to_string(y) + " " +
                               std::to_string(z),
                           MaterialId{std::uint32_t{kind}});
          constexpr int kSide = static_cast<int>(kChunk);
          ChunkMesh(mesh, cubes, {x * kSide, y * kSide, z * kSide}, kind).add();
        }
      }
    }
  }
}

// Clears the cubes that the walk comes near to.
void clear(ValueGrid& grid, const std::vector<Vec3d>& walk) {
  for (const Vec3d& p : walk) {
    const Vec3d at = p - grid.origin;
    constexpr int kReach = 2;
    for (int k = 0; k < 125; ++k) {
      const std::array<int, 3> offset{k % 5 - kReach, k / 5 % 5 - kReach, k / 25 - kReach};
      std::array<std::uint32_t, 3> cube{};
      Vec3d nearest;
      for (int axis = 0; axis < 3; ++axis) {
        const double centre = std::floor(at[axis] + 0.5) + offset[axis];
        cube[axis] = static_cast<std::uint32_t>(std::clamp(centre, 1.0, grid.points[axis] - 2.0));
        nearest[axis] = std::clamp(at[axis], cube[axis] - 0.5, cube[axis] + 0.5);
      }
      if (length(nearest - at) < kWalkRoom) {
        grid.values[grid.index(cube[0], cube[1], cube[2])] = -1.0f;
      }
    }
  }
}

// Crates and lamps, each in the middle of a free cube above a solid one.
void addThings(MeshBuilder& mesh, const Cubes& cubes, const std::vector<Vec3d>& walk, Random random) {
  std::uint32_t number = 0;
  cubes.forEach([&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    const std::array<int, 3> cube{static_cast<int>(x), static_cast<int>(y), static_cast<int>(z)};
    const std::array<int, 3> below{cube[0], cube[1], cube[2] - 1};
    if (cubes.at(cube) != kAir || cubes.at(below) == kAir || !random.chance(0.06)) {
      return;
    }
    const Vec3d floor = cubes.corner(cube) + Vec3d(0.5, 0.5, 0.0);
    if (distanceToLine({floor.x, floor.y}, walk) < kThingsFromWalk) {
      return;
    }
    const bool crate = random.chance(0.7);
    const double half = crate ? 0.375 : 0.125, height = crate ? 0.75 : 0.5;
    mesh.startObject((crate ? "crate " : "lamp ") + std::to_string(number++),
                     MaterialId{std::uint32_t{crate ? kCrate : kLamp}});
    mesh.box(floor - Vec3d(half, half, 0.0), floor + Vec3d(half, half, height));
  });
}

}  // namespace
}  // namespace scenes::voxels

Scene makeVoxels(const VoxelOptions& options) {
  using namespace scenes;
  Scene scene;
  scene.materials = voxels::materials();
  const cave::Plan plan = cave::makePlan(options.halls, Random(options.seed, 1));
  const std::vector<Vec3d> walk = cave::walkLine(plan);
  ValueGrid grid = cave::hollowCubes(plan, Random(options.seed, 2).next());
  voxels::clear(grid, walk);
  const voxels::Cubes cubes(grid, Random(options.seed, 4).next());
  {
    MeshBuilder mesh(scene);
    voxels::addCubes(mesh, cubes);
    voxels::addThings(mesh, cubes, walk, Random(options.seed, 3));
  }
  weldPositions(scene);
  updateBounds(scene);
  scene.paths = {
      walkAlong(walk, {.name = "tunnels", .look_ahead = 3.0, .calm = 3, .max_turn = 0.06, .far = 600.0})};
  return scene;
}

}  // namespace sightline
