#include "src/render/layers/convex_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "sightline/layers/hull.h"
#include "tests/render/test_scene.h"

namespace sightline::render {
namespace {

struct Mesh {
  std::vector<Vec3f> positions;
  std::vector<std::uint32_t> indices;

  bool once(bool double_sided = false) const { return coversOnce(positions, indices, double_sided); }
  void turnInsideOut() {
    for (std::size_t i = 0; i < indices.size(); i += 3) {
      std::swap(indices[i + 1], indices[i + 2]);
    }
  }
};

Mesh box(const Vec3f& low, const Vec3f& high) {
  SceneMaker maker;
  maker.box(low, high, kRed);
  return {maker.scene.positions, maker.scene.indices};
}

// Adds a rectangle in the plane z = height with its front towards +z.
void addRectangle(Mesh& mesh, float x0, float y0, float x1, float y1, float height = 0.0f) {
  const auto base = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(),
                        {{x0, y0, height}, {x1, y0, height}, {x1, y1, height}, {x0, y1, height}});
  for (const std::uint32_t corner : {0u, 1u, 2u, 0u, 2u, 3u}) {
    mesh.indices.push_back(base + corner);
  }
}

Mesh hullMesh(std::mt19937& random) {
  std::normal_distribution<double> normal;
  std::vector<Vec3d> points;
  for (int i = 0; i < 40; ++i) {
    const Vec3d direction = normalized(Vec3d(normal(random), normal(random), normal(random)));
    points.push_back(Vec3d(Vec3f(direction * 3.0 + Vec3d(20.0, -7.0, 4.0))));
  }
  const ConvexHull hull = buildHull(points).value();
  Mesh mesh;
  for (const Vec3d& vertex : hull.vertices) {
    mesh.positions.emplace_back(vertex);
  }
  for (const auto& triangle : hull.triangles) {
    mesh.indices.insert(mesh.indices.end(), triangle.begin(), triangle.end());
  }
  return mesh;
}

// How many fronts (or, double-sided, triangles) a ray from `eye` along `direction` goes through.
int crossings(const Mesh& mesh, const Vec3d& eye, const Vec3d& direction, bool double_sided) {
  int count = 0;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    Vec3d corner[3];
    for (std::size_t k = 0; k < 3; ++k) {
      corner[k] = Vec3d(mesh.positions[mesh.indices[i + k]]) - eye;
    }
    int positive = 0, negative = 0;
    for (int k = 0; k < 3; ++k) {
      (dot(cross(corner[k], corner[(k + 1) % 3]), direction) > 0.0 ? positive : negative) += 1;
    }
    const Vec3d normal = cross(corner[1] - corner[0], corner[2] - corner[0]);
    const bool ahead = dot(normal, corner[0]) * dot(normal, direction) > 0.0;
    const bool front = dot(normal, direction) < 0.0;
    count += (positive == 3 || negative == 3) && ahead && (front || double_sided) ? 1 : 0;
  }
  return count;
}

TEST(CoversOnce, ConvexSurfacesDoWhereverTheyLie) {
  EXPECT_TRUE(box({-1, -1, -1}, {1, 1, 1}).once());
  EXPECT_TRUE(box({900.25f, -3.5f, 17.125f}, {901.75f, -3.46875f, 19.5f}).once());
  for (unsigned seed = 1; seed <= 5; ++seed) {
    std::mt19937 random(seed);
    Mesh mesh = hullMesh(random);
    EXPECT_TRUE(mesh.once()) << "seed " << seed;
    mesh.indices.resize(mesh.indices.size() / 6 * 3);  // a part of the surface
    EXPECT_TRUE(mesh.once()) << "seed " << seed;
  }
}

TEST(CoversOnce, RoundingOfTurnedBoxesDoesNotMatter) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    const Vec3d x = normalized(Vec3d(any(random), any(random), any(random)));
    const Vec3d y = normalized(cross(x, Vec3d(any(random), any(random), any(random))));
    const Vec3d z = cross(x, y), at = Vec3d(any(random), any(random), any(random)) * 30.0;
    Mesh mesh = box({-0.8f, -0.015f, 0.0f}, {0.8f, 0.015f, 2.4f});
    for (Vec3f& p : mesh.positions) {
      p = Vec3f(at + x * double{p.x} + y * double{p.y} + z * double{p.z});
    }
    EXPECT_TRUE(mesh.once()) << "seed " << seed;
  }
}

TEST(CoversOnce, ADentABackAndAnInsideDoNot) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    Mesh mesh = hullMesh(random);
    EXPECT_FALSE(mesh.once(true)) << "seed " << seed;
    Mesh inside = mesh;
    inside.turnInsideOut();
    EXPECT_FALSE(inside.once()) << "seed " << seed;
    const Vec3f middle(20.0f, -7.0f, 4.0f);
    Vec3f& dented = mesh.positions[seed % mesh.positions.size()];
    dented = middle + (dented - middle) * 0.5f;
    EXPECT_FALSE(mesh.once()) << "seed " << seed;
  }
}

TEST(CoversOnce, FlatMeshesDoUnlessTrianglesLieInEachOthersPlace) {
  Mesh mesh;
  addRectangle(mesh, 0, 0, 1, 2);
  addRectangle(mesh, 1, 0, 3, 1);
  EXPECT_TRUE(mesh.once());
  EXPECT_TRUE(mesh.once(true));
  Mesh twice = mesh;
  addRectangle(twice, 0, 0, 1, 2);
  EXPECT_FALSE(twice.once());
  Mesh partly = mesh;
  addRectangle(partly, 2.5f, 0.5f, 4, 3);
  EXPECT_FALSE(partly.once());
}

TEST(CoversOnce, FacesBackToBackAreSeenOneAtATime) {
  Mesh mesh;
  addRectangle(mesh, 0, 0, 1, 1);
  mesh.turnInsideOut();
  addRectangle(mesh, 0, 0, 1, 1);
  EXPECT_TRUE(mesh.once());
  EXPECT_FALSE(mesh.once(true));
}

TEST(CoversOnce, OnePlaneBeforeAnotherDoesNot) {
  Mesh mesh;
  addRectangle(mesh, 0, 0, 1, 1);
  addRectangle(mesh, 5, 5, 6, 6, 0.5f);
  EXPECT_FALSE(mesh.once());
}

TEST(CoversOnce, OddInputIsAnswered) {
  EXPECT_TRUE(Mesh{}.once());
  Mesh mesh = box({-1, -1, -1}, {1, 1, 1});
  mesh.indices.insert(mesh.indices.end(), {0, 0, 1, 2, 2, 2});  // without area
  EXPECT_TRUE(mesh.once());
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    Mesh broken = mesh;
    broken.positions[3].y = bad;
    EXPECT_FALSE(broken.once());
  }
  Mesh large;
  for (int i = 0; i < 4097; ++i) {
    addRectangle(large, static_cast<float>(i), 0, static_cast<float>(i + 1), 1);
  }
  EXPECT_FALSE(large.once());
}

// No ray crosses a mesh twice of which coversOnce() is true.
TEST(CoversOnce, RaysAgreeOnAFewTrianglesAnyhow) {
  std::size_t once = 0;
  for (unsigned seed = 1; seed <= 400; ++seed) {
    std::mt19937 random(seed);
    std::uniform_int_distribution<int> grid(0, 3);
    const auto any_point = [&] {
      const int x = grid(random), y = grid(random), z = grid(random);
      return Vec3f(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
    };
    Mesh mesh;
    for (std::uint32_t i = 0; i < 6; ++i) {
      mesh.positions.push_back(any_point());
      mesh.indices.push_back(i);
    }
    const bool double_sided = seed % 2 == 0;
    if (!mesh.once(double_sided)) {
      continue;
    }
    ++once;
    std::uniform_real_distribution<double> near(-0.5, 3.5), far(-8.0, 11.0);
    for (int ray = 0; ray < 2000; ++ray) {
      const Vec3d eye(far(random), far(random), far(random));
      const Vec3d target(near(random), near(random), near(random));
      ASSERT_LE(crossings(mesh, eye, target - eye, double_sided), 1) << "seed " << seed;
    }
  }
  EXPECT_GT(once, 40u);
}

}  // namespace
}  // namespace sightline::render
