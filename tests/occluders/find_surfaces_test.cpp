// That surfaces are the same however the work is cut, and how positions become vertices.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include "scenes/landscapes.h"
#include "scenes/procedural.h"
#include "sightline/occluders/surface_set.h"
#include "tests/occluders/triangle_soup.h"
#include "tests/support/cut_work.h"
#include "tests/support/made_surfaces.h"
#include "tests/support/rounds.h"
#include "tests/support/solids.h"

namespace sightline {
namespace {

LargeVector<std::byte> bytesOf(const Scene& scene, const SurfaceSettings& settings,
                               const ParallelFor& parallel_for) {
  return surfaceBytes(findSurfaces(scene.view(), settings, parallel_for));
}

// The same scene with three positions of its own for each triangle, in random places of the array, some of
// them with -0 for 0; some triangles are not finite.
Scene takenApart(const Scene& scene, std::uint32_t seed) {
  std::mt19937 random(seed);
  Scene apart = scene;
  std::vector<std::uint32_t> place(scene.indices.size());
  for (std::uint32_t i = 0; i < place.size(); ++i) {
    place[i] = i;
  }
  std::shuffle(place.begin(), place.end(), random);
  apart.positions.resize(place.size());
  for (std::size_t i = 0; i < place.size(); ++i) {
    Vec3f p = scene.positions[scene.indices[i]];
    p.x = p.x == 0.0f && random() % 2 == 0 ? -0.0f : p.x;
    p.y = random() % 5000 == 0 ? std::numeric_limits<float>::infinity() : p.y;
    apart.positions[place[i]] = p;
    apart.indices[i] = place[i];
  }
  return apart;
}

TEST(FindSurfaces, DoNotDependOnHowTheWorkIsCut) {
  std::vector<Scene> scenes;
  scenes.push_back(makeCity({.copies = 3}));
  if (!test::sanitized()) {  // the work is cut in the same places, whatever the scene
    scenes.push_back(takenApart(makeBuilding({.floors = 1, .plants = 1}), 1));
    scenes.push_back(makeCave({.halls = 2, .triangles = 20000}));  // one sheet, of which parts are gathered
  }
  for (const Scene& scene : scenes) {
    ASSERT_GT(scene.triangleCount(), 20000u);  // several parts of each step
    for (const SurfaceSettings& settings :
         {SurfaceSettings{},
          SurfaceSettings{.part_triangles = 50, .cluster_triangles = 3, .join_edges = false}}) {
      const LargeVector<std::byte> serial = bytesOf(scene, settings, serialFor);
      EXPECT_EQ(serial, bytesOf(scene, settings, backwardsBy(1)));
      EXPECT_EQ(serial, bytesOf(scene, settings, onThreads(4)));
    }
  }
}

TEST(FindSurfaces, HaveAVertexForEachDifferentPositionInTheOrderOfUse) {
  const Scene scene = takenApart(makeBuilding({.floors = 2, .plants = 20}), 2);
  const SurfaceSet set = findSurfaces(scene.view(), {.join_edges = false}, onThreads(3));
  std::map<std::tuple<float, float, float>, std::size_t> numbers;  // -0 and 0 are the same key
  std::vector<Vec3f> expected;
  std::size_t triangles = 0;
  for (const Object& object : scene.objects) {
    for (std::uint32_t t = 0; scene.materials[object.material.value].opaque() && t < object.triangleCount();
         ++t) {
      const std::uint32_t* corners = &scene.indices[object.first_index + 3 * t];
      const Vec3f a = scene.positions[corners[0]], b = scene.positions[corners[1]],
                  c = scene.positions[corners[2]];
      if (object.mark == OccluderMark::kNever || !isFinite(a) || !isFinite(b) || !isFinite(c)) {
        continue;
      }
      triangles += a != b && b != c && c != a ? 1 : 0;
      for (const Vec3f& p : {a, b, c}) {
        if (numbers.emplace(std::tuple(p.x, p.y, p.z), expected.size()).second) {
          expected.push_back(p);
        }
      }
    }
  }
  EXPECT_LT(expected.size(), scene.positions.size() / 2);
  EXPECT_TRUE(std::equal(set.vertices.begin(), set.vertices.end(), expected.begin(), expected.end()));
  EXPECT_EQ(set.triangles.size(), 3 * triangles);
}

TEST(FindSurfaces, AClosedShapeIsOnePartHoweverItIsTurned) {
  // The cosine of two opposite normals may be below -1 by a rounding.
  constexpr std::size_t kBoxes = 1000;
  std::mt19937 random(7);
  std::uniform_real_distribution<> anywhere(-1.0, 1.0);
  const auto direction = [&] { return Vec3d(anywhere(random), anywhere(random), anywhere(random)); };
  test::Soup soup;
  for (std::size_t i = 0; i < kBoxes; ++i) {
    const Vec3d normal = normalized(direction()), x = normalized(cross(normal, direction()));
    const test::Solid box = test::placed(test::block({0, 0, 0}, {2, 3, 4}),
                                         Vec3d(10.0 * static_cast<double>(i), 0.0, 0.0), x, cross(normal, x));
    for (std::size_t face = 0; face < box.faces.size(); ++face) {
      const std::vector<Vec3f> corners = box.polygon(face);
      soup.add(Vec3d(corners[0]), Vec3d(corners[1]), Vec3d(corners[2]));
      soup.add(Vec3d(corners[0]), Vec3d(corners[2]), Vec3d(corners[3]));
    }
  }
  const Scene scene = test::sceneOf(soup);
  const SurfaceSet set = findSurfaces(scene.view());
  EXPECT_EQ(set.triangles.size(), 3 * 12 * kBoxes);
  EXPECT_EQ(set.parts.size(), kBoxes);
  for (const SurfacePart& part : set.parts) {
    EXPECT_EQ(part.edge_count, 0u);
  }
}

// A boundary in pieces that have no other point of the lattice of whole numbers: how often each is run
// along, less how often it is run back. Pieces run upwards.
using Pieces = std::map<std::array<int, 6>, int>;

void addPieces(const Vec3f& from, const Vec3f& to, int value, Pieces& pieces) {
  std::array<int, 3> at{}, step{};
  int steps = 0;
  for (int axis = 0; axis < 3; ++axis) {
    at[axis] = static_cast<int>(from[axis]);
    step[axis] = static_cast<int>(to[axis]) - at[axis];
    steps = std::gcd(steps, step[axis]);
  }
  for (int i = 0; i < steps; ++i) {
    std::array<int, 3> next = at;
    for (int axis = 0; axis < 3; ++axis) {
      next[axis] += step[axis] / steps;
    }
    const bool up = at < next;
    const std::array<int, 3>&low = up ? at : next, &high = up ? next : at;
    const std::array key{low[0], low[1], low[2], high[0], high[1], high[2]};
    if ((pieces[key] += up ? value : -value) == 0) {
      pieces.erase(key);
    }
    at = next;
  }
}

TEST(FindSurfaces, ChainsAreTheBoundariesOfTheirClusters) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    test::Soup soup = test::greedyVoxels(seed, 5);
    test::SoupRandom random(seed);
    const auto corner = [&] { return Vec3d(random.below(7), random.below(7), random.below(7)); };
    for (int i = 0; i < 60; ++i) {  // which cross and touch whatever is there
      soup.add(corner(), corner(), corner());
    }
    const SurfaceSet set = findSurfaces(test::sceneOf(soup).view(), {.cluster_triangles = 1 + seed % 7});
    for (std::uint32_t c = 0; c < set.clusters.size(); ++c) {
      Pieces of_triangles, of_chains;
      const std::span<const std::uint32_t> corners = set.trianglesOf(set.clusters[c]);
      for (std::size_t i = 0; i < corners.size(); ++i) {
        addPieces(set.vertices[corners[i]], set.vertices[corners[i % 3 == 2 ? i - 2 : i + 1]], 1,
                  of_triangles);
      }
      for (const std::uint32_t number : set.chainsOf(set.clusters[c])) {
        const std::span<const Vec3f> vertices = set.verticesOf(set.chains[number]);
        for (const ChainUse& use : set.usesOf(set.chains[number])) {
          for (std::size_t i = 1; use.cluster == c && i < vertices.size(); ++i) {
            addPieces(vertices[i - 1], vertices[i], use.value, of_chains);
          }
        }
      }
      ASSERT_EQ(of_triangles, of_chains) << "seed " << seed << ", cluster " << c;
    }
  }
}

// A sheet of width x 1 squares at a height, from x on.
void addRow(test::Soup& soup, int x, int width, double y) {
  for (int i = x; i < x + width; ++i) {
    soup.addQuad({double(i), y, 0}, {i + 1.0, y, 0}, {i + 1.0, y + 1, 0}, {double(i), y + 1, 0});
  }
}

TEST(FindSurfaces, AVertexOnAStraightBoundaryIsLeftOut) {
  test::Soup sheet;
  for (int y = 0; y < 10; ++y) {
    addRow(sheet, 0, 10, y);
  }
  const SurfaceSet flat = findSurfaces(test::sceneOf(sheet).view());
  ASSERT_EQ(flat.patches.size(), 1u);
  EXPECT_GT(flat.clusters.size(), 1u);
  // The outline is cut only where one cluster ends and another begins.
  std::uint32_t corners = 0;
  for (const PatchChain& chain : flat.chainsOf(flat.patches[0])) {
    corners += flat.chains[chain.chain].vertex_count - 2;
  }
  EXPECT_LE(corners, 4u);
  EXPECT_LT(flat.patches[0].edge_count, 40u);

  // A vertex that is off by a unit in the last place stays.
  test::Soup row;
  addRow(row, 1, 6, 0);
  const auto edgesOf = [](const test::Soup& soup) {
    const SurfaceSet set = findSurfaces(test::sceneOf(soup).view());
    EXPECT_EQ(set.clusters.size(), 1u);
    return set.patches.at(0).edge_count;
  };
  EXPECT_EQ(edgesOf(row), 4u);
  for (Vec3d& v : row.vertices) {
    v.y = v == Vec3d{4, 1, 0} ? double{std::nextafterf(1.0f, 2.0f)} : v.y;
  }
  EXPECT_EQ(edgesOf(row), 7u);  // the upper side has four: to the left, up, down, to the right
}

TEST(FindSurfaces, APartThatIsHalfFullEndsAtAJunction) {
  const auto partsOf = [](int width) {
    test::Soup soup;
    addRow(soup, 0, width, 0);
    // Its lower corners lie on the upper edge of the last square.
    soup.addQuad({width - 0.75, 1, 0}, {width - 0.25, 1, 0}, {width - 0.25, 2, 0}, {width - 0.75, 2, 0});
    return findSurfaces(test::sceneOf(soup).view(), {.part_triangles = 40}).parts.size();
  };
  EXPECT_EQ(partsOf(5), 1u);
  EXPECT_EQ(partsOf(15), 2u);
}

// The edges of triangles, in both directions, less what the chains of each cluster say: empty if these are
// its boundary.
std::string whatChainsGetWrong(const SurfaceSet& set) {
  using Edge = std::array<float, 6>;
  for (std::uint32_t c = 0; c < set.clusters.size(); ++c) {
    std::map<Edge, int> edges;
    const auto add = [&](const Vec3f& a, const Vec3f& b, int value) {
      edges[{a.x, a.y, a.z, b.x, b.y, b.z}] += value;
      edges[{b.x, b.y, b.z, a.x, a.y, a.z}] -= value;
    };
    const auto corners = set.trianglesOf(set.clusters[c]);
    for (std::size_t i = 0; i < corners.size(); i += 3) {
      for (std::size_t k = 0; k < 3; ++k) {
        add(set.vertices[corners[i + k]], set.vertices[corners[i + (k + 1) % 3]], 1);
      }
    }
    for (const std::uint32_t number : set.chainsOf(set.clusters[c])) {
      const auto vertices = set.verticesOf(set.chains[number]);
      for (const ChainUse& use : set.usesOf(set.chains[number])) {
        for (std::size_t i = 1; use.cluster == c && i < vertices.size(); ++i) {
          add(vertices[i - 1], vertices[i], -use.value);
        }
      }
    }
    for (const auto& [edge, value] : edges) {
      if (value != 0) {
        return "cluster " + std::to_string(c) + ": an edge is left " + std::to_string(value) + " times";
      }
    }
  }
  return "";
}

TEST(FindSurfaces, EveryTriangleIsInOneClusterAndChainsAreItsBoundary) {
  const Scene scene = test::sheet(
      13, 20.0f, 10.0f, [](float x, float y) { return std::sin(x) + std::cos(3.0f * y); },
      [](std::uint32_t t) { return t % 11 == 0; });
  const SurfaceSet set =
      findSurfaces(scene.view(), {.part_triangles = 50, .patch_triangles = 20, .cluster_triangles = 7});
  EXPECT_EQ(set.triangles.size(), scene.view().indices.size());
  EXPECT_TRUE(std::all_of(set.clusters.begin(), set.clusters.end(),
                          [](const SurfaceCluster& c) { return c.triangle_count <= 7; }));
  EXPECT_EQ(whatChainsGetWrong(set), "");
}

// Leaves around one edge, as those of a revolving door, so many of them in one place. Some are turned over,
// and some have a tip farther up. No two lie on one line, where chains would leave the vertex between out.
Scene leaves(std::uint32_t count, std::uint32_t coincident) {
  test::Soup soup;
  const auto snap = [](double x) { return std::round(x * 1024.0) / 1024.0; };
  for (std::uint32_t i = 0; i < count; ++i) {
    const double angle = 3.0 * (i / coincident) / count;
    const Vec3d tip{snap(std::cos(angle)), snap(std::sin(angle)), i % 5 == 0 ? 0.5 : 0.0};
    i % 3 == 0 ? soup.add({0, 0, 1}, {0, 0, 0}, tip) : soup.add({0, 0, 0}, {0, 0, 1}, tip);
  }
  return test::sceneOf(soup);
}

TEST(FindSurfaces, ChainsAreTheBoundaryOfClustersAroundOneEdgeToo) {
  for (const std::uint32_t count : {3u, 64u, 65u, 500u}) {
    for (const std::uint32_t coincident : {1u, 4u, 500u}) {
      const Scene scene = leaves(count, coincident);
      for (const SurfaceSettings& settings :
           {SurfaceSettings{},
            SurfaceSettings{
                .part_triangles = 50, .patch_triangles = 20, .cluster_triangles = 7, .max_angle_deg = 30.0},
            SurfaceSettings{.part_triangles = 1}}) {
        const SurfaceSet set = findSurfaces(scene.view(), settings);
        EXPECT_EQ(set.triangles.size(), scene.indices.size());
        EXPECT_EQ(whatChainsGetWrong(set), "") << count << " leaves, " << coincident << " in one place";
        EXPECT_EQ(surfaceBytes(set), bytesOf(scene, settings, onThreads(3)));
      }
    }
  }
}

Scene trianglesInOnePlace(std::uint32_t count) {
  Scene scene = leaves(1, 1);
  for (std::uint32_t i = 1; i < count; ++i) {
    scene.indices.insert(scene.indices.end(), {0u, 1u, 2u});
  }
  scene.objects[0].index_count = 3 * count;
  return scene;
}

TEST(FindSurfaces, FullPartsAreTakenFromTrianglesInOnePlace) {
  // All are neighbours of one another, so only a full part, patch or cluster ends before the last of them.
  const SurfaceSet set =
      findSurfaces(trianglesInOnePlace(500).view(),
                   {.part_triangles = 100, .patch_triangles = 50, .cluster_triangles = 25});
  EXPECT_EQ(set.parts.size(), 5u);
  EXPECT_EQ(set.patches.size(), 10u);
  EXPECT_EQ(set.clusters.size(), 20u);
  for (std::uint32_t part = 0; part < 5; ++part) {
    EXPECT_EQ(set.adjoiningOf(part).size(), 16u);
  }
}

TEST(FindSurfaces, TakeNoLongerForTrianglesInOnePlace) {
  // If each looked at all others here, this would take minutes.
  const std::uint32_t count = 100000;
  const SurfaceSet set = findSurfaces(trianglesInOnePlace(count).view());
  EXPECT_EQ(set.parts.size(), (count + 1023) / 1024);
  ASSERT_EQ(set.chains.size(), 1u);
  EXPECT_EQ(set.chains[0].use_count, set.clusters.size());
  std::int64_t sum = 0;
  for (const ChainUse& use : set.uses) {
    sum += use.value;
  }
  EXPECT_EQ(std::abs(sum), count);

  EXPECT_EQ(findSurfaces(leaves(count, 1).view()).triangles.size(), 3 * count);
}

}  // namespace
}  // namespace sightline
