#include "scenes/surface_nets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <utility>

#include "scenes/random.h"

namespace sightline::scenes {
namespace {

ValueGrid gridOf(std::uint32_t points, double cell) {
  ValueGrid grid;
  grid.cell = cell;
  grid.points = {points, points, points};
  grid.values.assign(std::size_t{points} * points * points, 1.0f);
  return grid;
}

template <typename Value>
void fill(ValueGrid& grid, const Value& value) {
  for (std::uint32_t z = 0; z < grid.points[2]; ++z) {
    for (std::uint32_t y = 0; y < grid.points[1]; ++y) {
      for (std::uint32_t x = 0; x < grid.points[0]; ++x) {
        grid.values[grid.index(x, y, z)] = static_cast<float>(value(grid.point(x, y, z)));
      }
    }
  }
}

// Returns true if each edge of the quads belongs to one quad in either direction.
bool isManifold(const SurfaceNet& net) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& quad : net.quads) {
    for (std::size_t i = 0; i < 4; ++i) {
      ++edges[{quad[i], quad[(i + 1) % 4]}];
    }
  }
  return std::all_of(edges.begin(), edges.end(), [&](const auto& edge) {
    const auto back = edges.find({edge.first.second, edge.first.first});
    return edge.second == 1 && back != edges.end() && back->second == 1;
  });
}

double volumeInside(const SurfaceNet& net) {
  double sixfold = 0.0;
  for (const auto& quad : net.quads) {
    for (std::size_t i = 1; i < 3; ++i) {
      sixfold += dot(net.points[quad[0]], cross(net.points[quad[i]], net.points[quad[i + 1]]));
    }
  }
  return sixfold / 6.0;
}

TEST(SurfaceNets, AHollowBallIsClosedAndSeenFromInside) {
  ValueGrid grid = gridOf(30, 0.1);
  const Vec3d middle(1.4, 1.45, 1.5);
  fill(grid, [&](const Vec3d& p) { return length(p - middle) - 1.0; });
  const SurfaceNet net = surfaceNet(grid);
  EXPECT_TRUE(isManifold(net));
  EXPECT_NEAR(volumeInside(net), -4.18879, 0.15);
  for (const Vec3d& point : net.points) {
    EXPECT_NEAR(length(point - middle), 1.0, 0.1);
  }
}

TEST(SurfaceNets, WithoutFreeSpaceThereIsNone) {
  EXPECT_TRUE(surfaceNet(gridOf(5, 1.0)).quads.empty());
}

TEST(SurfaceNets, OfTwoHollowsOnlyTheOneWithTheStartIsLeft) {
  ValueGrid grid = gridOf(40, 0.1);
  const Vec3d left(1.0, 2.0, 2.0), right(2.9, 2.0, 2.0);
  fill(grid, [&](const Vec3d& p) { return std::min(length(p - left), length(p - right)) - 0.7; });
  keepConnected(grid, right);
  const SurfaceNet net = surfaceNet(grid);
  EXPECT_FALSE(net.quads.empty());
  for (const Vec3d& point : net.points) {
    EXPECT_LT(length(point - right), 0.8);
  }
}

TEST(SurfaceNets, AStoneThatFloatsInAHollowIsRemoved) {
  ValueGrid grid = gridOf(40, 0.1);
  const Vec3d middle(2.0, 2.0, 2.0);
  fill(grid, [&](const Vec3d& p) {
    const double r = length(p - middle);
    return std::max(r - 1.5, 0.4 - r);
  });
  keepConnected(grid, middle + Vec3d(1.0, 0.0, 0.0));
  for (const Vec3d& point : surfaceNet(grid).points) {
    EXPECT_GT(length(point - middle), 1.3);
  }
}

TEST(SurfaceNets, FilledPinchesLeaveEachEdgeToTwoQuads) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    ValueGrid grid = gridOf(12, 1.0);
    fill(grid, [&](const Vec3d& p) {
      const bool border = std::min({p.x, p.y, p.z}) < 1.0 || std::max({p.x, p.y, p.z}) > 10.0;
      const double value = random.range(-1.0, 0.6);
      return border ? 1.0 : value;
    });
    EXPECT_FALSE(isManifold(surfaceNet(grid))) << "seed " << seed;
    fillPinches(grid);
    EXPECT_TRUE(isManifold(surfaceNet(grid))) << "seed " << seed;
  }
}

}  // namespace
}  // namespace sightline::scenes
