// Compares merged polygons with the triangles that they were made of, at points of their plane.

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <string>

#include "tests/occluders/flat_mesh.h"
#include "tests/support/rounds.h"

namespace sightline {
namespace {

using namespace flat_mesh;

enum class Family {
  kGrid,        // all cells
  kHoles,       // windows
  kManyHoles,   // half of the cells
  kLShape,      // a corner left out
  kTJunctions,  // rows that share no vertices
  kFan,         // of a star-shaped outline
  kDisc,        // a regular polygon around its centre
  kLooseEnds,   // triangles over few points, overlapping at random
};
constexpr Family kFamilies[] = {Family::kGrid,       Family::kHoles, Family::kManyHoles, Family::kLShape,
                                Family::kTJunctions, Family::kFan,   Family::kDisc,      Family::kLooseEnds};

FlatMesh rowsWithoutCommonVertices(Random& random) {
  FlatMesh mesh;
  const double width = random.in(2.0, 9.0);
  double y = 0.0;
  for (int row = 0; row < 4; ++row) {
    const double next_y = y + random.in(0.3, 2.0);
    std::vector<double> xs{0.0, width};
    for (std::uint32_t i = 0; i < 1 + random.below(5); ++i) {
      xs.push_back(width * (1 + random.below(63)) / 64.0);
    }
    std::sort(xs.begin(), xs.end());
    xs.erase(std::unique(xs.begin(), xs.end()), xs.end());
    const auto first = static_cast<std::uint32_t>(mesh.points.size());
    for (const double x : xs) {
      mesh.add({x, y});
      mesh.add({x, next_y});
    }
    for (std::uint32_t i = 0; i + 1 < xs.size(); ++i) {
      const std::uint32_t a = first + 2 * i;
      mesh.addQuad(a, a + 2, a + 3, a + 1, random.below(2) == 0);
    }
    y = next_y;
  }
  return mesh;
}

FlatMesh fan(Random& random, std::uint32_t n, double low, double high) {
  FlatMesh mesh;
  const std::uint32_t middle = mesh.add({0, 0});
  for (std::uint32_t i = 0; i < n; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / n, r = random.in(low, high);
    mesh.add({r * std::cos(angle), r * std::sin(angle)});
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    mesh.triangles.push_back({middle, 1 + i, 1 + (i + 1) % n});
  }
  return mesh;
}

FlatMesh looseEnds(Random& random) {
  FlatMesh mesh;
  const std::uint32_t n = 6 + random.below(6);
  for (std::uint32_t i = 0; i < n; ++i) {
    mesh.add({random.in(0, 5), random.in(0, 5)});
  }
  for (std::uint32_t i = 0; i < 14; ++i) {
    std::array<std::uint32_t, 3> t{random.below(n), random.below(n), random.below(n)};
    if (crossAt(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]) < 0.0) {
      std::swap(t[1], t[2]);
    }
    mesh.triangles.push_back(t);
  }
  return mesh;
}

FlatMesh meshOf(Family family, Random& random) {
  const std::vector<double> xs = steps(random, 2 + random.below(7)), ys = steps(random, 2 + random.below(7));
  const auto columns = static_cast<std::uint32_t>(xs.size() - 1),
             rows = static_cast<std::uint32_t>(ys.size() - 1);
  const std::uint32_t cut_column = random.below(columns), cut_row = random.below(rows);
  std::vector<bool> hole(columns * rows);
  for (std::size_t i = 0; i < hole.size(); ++i) {
    hole[i] = random.below(family == Family::kManyHoles ? 2 : 6) == 0;
  }
  switch (family) {
    case Family::kGrid:
      return grid(xs, ys, random, [](std::uint32_t, std::uint32_t) { return true; });
    case Family::kHoles:
    case Family::kManyHoles:
      return grid(xs, ys, random, [&](std::uint32_t c, std::uint32_t r) { return !hole[r * columns + c]; });
    case Family::kLShape:
      return grid(xs, ys, random, [&](std::uint32_t c, std::uint32_t r) {
        return c < cut_column || r < cut_row || c + r == 0;
      });
    case Family::kTJunctions:
      return rowsWithoutCommonVertices(random);
    case Family::kFan:
      return fan(random, 5 + random.below(20), 1.0, 5.0);
    case Family::kDisc:
      return fan(random, 3 + random.below(40), 3.0, 3.0);
    case Family::kLooseEnds:
      return looseEnds(random);
  }
  return {};
}

struct Cover {
  std::vector<std::vector<Point2>> triangles, polygons;
  Point2 low{1e300, 1e300}, high{-1e300, -1e300};
  double unsure = 0.0;  // nearer to a triangle's edge than this nothing is said
};

Cover coverOf(const Scene& scene, const OccluderSet& set, const Placement& place) {
  Cover cover;
  double largest = 0.0;
  for (std::size_t i = 0; i + 2 < scene.indices.size(); i += 3) {
    std::vector<Point2>& triangle = cover.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f& corner = scene.positions[scene.indices[i + k]];
      const Point2 p = place.inverse(corner);
      triangle.push_back(p);
      cover.low = {std::min(cover.low.x, p.x), std::min(cover.low.y, p.y)};
      cover.high = {std::max(cover.high.x, p.x), std::max(cover.high.y, p.y)};
      largest = std::max(largest, static_cast<double>(maxComponent(abs(corner))));
    }
  }
  for (const Occluder& occluder : set.occluders) {
    cover.polygons.push_back(flattened(set, occluder, place));
  }
  cover.unsure = 64.0 * 0x1p-24 * largest;
  return cover;
}

// The numbers of points covered by a polygon but no triangle, by a triangle but no polygon, or by two
// polygons.
struct Disagreement {
  int decided = 0, only_polygon = 0, only_triangle = 0, twice = 0;
};

Disagreement compareAtRandomPoints(const Cover& cover, int samples, Random& random) {
  Disagreement result;
  for (int s = 0; s < samples; ++s) {
    const double margin = 0.1 * (cover.high.x - cover.low.x);
    const Point2 p{random.in(cover.low.x - margin, cover.high.x + margin),
                   random.in(cover.low.y - margin, cover.high.y + margin)};
    bool in_triangle = false, unsure = false;
    for (const auto& triangle : cover.triangles) {
      const double depth = depthIn(triangle, p);
      in_triangle |= depth > cover.unsure;
      unsure |= std::abs(depth) <= cover.unsure;
    }
    int polygons = 0;
    for (const auto& polygon : cover.polygons) {
      polygons += depthIn(polygon, p) > 0.0 ? 1 : 0;
    }
    if (!unsure) {
      ++result.decided;
      result.only_polygon += polygons > 0 && !in_triangle ? 1 : 0;
      result.only_triangle += polygons == 0 && in_triangle ? 1 : 0;
      result.twice += polygons > 1 ? 1 : 0;
    }
  }
  return result;
}

bool convexInSpace(std::span<const Point2> polygon, double tolerance) {
  double turned = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()],
                 &c = polygon[(i + 2) % polygon.size()];
    if (leftOf(a, b, c) < -tolerance) {
      return false;
    }
    turned += std::atan2(crossAt(a, b, c), (b.x - a.x) * (c.x - b.x) + (b.y - a.y) * (c.y - b.y));
  }
  return std::abs(turned - 2.0 * std::numbers::pi) < 1e-3;
}

std::string about(Family family, std::uint64_t seed, double distance) {
  return "family " + std::to_string(static_cast<int>(family)) + " seed " + std::to_string(seed) +
         " distance " + std::to_string(distance);
}

TEST(MergedPolygons, CoverExactlyTheirTrianglesAndNeverAHole) {
  int decided = 0;
  for (const Family family : kFamilies) {
    for (const double distance : {0.0, 100.0, 5000.0}) {
      for (std::uint64_t seed = 1; seed <= test::rounds(40u); ++seed) {
        Random random(seed);
        const FlatMesh mesh = meshOf(family, random);
        const Placement place =
            seed % 5 == 0 ? Placement{random.point(distance)} : anyPlacement(random, distance);
        const Scene scene = sceneOf(mesh, place);
        const OccluderSet set = findOccluders(scene.view(), kKeepAll);
        const Cover cover = coverOf(scene, set, place);
        const Disagreement found = compareAtRandomPoints(cover, 150, random);
        decided += found.decided;
        EXPECT_EQ(found.only_polygon, 0) << about(family, seed, distance);
        EXPECT_EQ(reported(set.report), mesh.triangles.size()) << about(family, seed, distance);
        if (family != Family::kLooseEnds) {
          EXPECT_EQ(found.only_triangle, 0) << about(family, seed, distance);
          EXPECT_EQ(found.twice, 0) << about(family, seed, distance);
          EXPECT_EQ(set.report.used, mesh.triangles.size()) << about(family, seed, distance);
        }
        for (const auto& polygon : cover.polygons) {
          EXPECT_TRUE(convexInSpace(polygon, cover.unsure)) << about(family, seed, distance);
        }
      }
    }
  }
  EXPECT_GT(decided, test::rounds(100000));
}

TEST(MergedPolygons, HaveTheAreaOfTheirTriangles) {
  for (const Family family : kFamilies) {
    if (family == Family::kLooseEnds) {
      continue;
    }
    for (std::uint64_t seed = 1; seed <= test::rounds(40u); ++seed) {
      Random random(seed);
      const FlatMesh mesh = meshOf(family, random);
      const Placement place = anyPlacement(random, 30.0);
      double area = 0.0;
      for (const auto& t : mesh.triangles) {
        area += 0.5 * crossAt(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]);
      }
      const OccluderSet set = findOccluders(sceneOf(mesh, place).view(), kKeepAll);
      double sum = 0.0;
      for (const Occluder& occluder : set.occluders) {
        EXPECT_NEAR(occluder.area, areaOf(flattened(set, occluder, place)), 1e-4 * occluder.area + 1e-4);
        sum += occluder.area;
      }
      EXPECT_NEAR(sum, area, 1e-4 * area) << about(family, seed, 30.0);
      EXPECT_NEAR(set.area, area, 1e-4 * area) << about(family, seed, 30.0);
    }
  }
}

TEST(MergedPolygons, HonourTheVertexLimitAndStillCoverEverything) {
  for (const Family family : {Family::kDisc, Family::kFan, Family::kHoles}) {
    for (std::uint64_t seed = 1; seed <= test::rounds(20u); ++seed) {
      for (const std::uint32_t limit : {3u, 4u, 5u, 8u, 16u}) {
        Random random(seed);
        const FlatMesh mesh = meshOf(family, random);
        const Placement place = anyPlacement(random, 10.0);
        const Scene scene = sceneOf(mesh, place);
        const OccluderSet set = findOccluders(scene.view(), {.max_vertices = limit, .area_fraction = 1.0});
        for (const Occluder& occluder : set.occluders) {
          EXPECT_LE(occluder.vertex_count, limit) << about(family, seed, 10.0);
          EXPECT_GE(occluder.vertex_count, 3u) << about(family, seed, 10.0);
        }
        const Disagreement found = compareAtRandomPoints(coverOf(scene, set, place), 60, random);
        EXPECT_EQ(found.only_polygon + found.only_triangle + found.twice, 0) << about(family, seed, 10.0);
      }
    }
  }
}

double distanceBeyond(std::span<const Point2> polygon, const Point2& p) {
  double nearest = 1e300;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double dx = b.x - a.x, dy = b.y - a.y;
    const double t = std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
    nearest = std::min(nearest, std::hypot(p.x - a.x - t * dx, p.y - a.y - t * dy));
  }
  return depthIn(polygon, p) >= 0.0 ? 0.0 : nearest;
}

TEST(MergedPolygons, StateASlackThatBoundsTheDistanceFromTheirTriangles) {
  for (const Family family : kFamilies) {
    for (std::uint64_t seed = 1; seed <= test::rounds(40u) && family != Family::kLooseEnds; ++seed) {
      Random random(seed);
      const double distance = seed % 2 == 0 ? 20.0 : 3000.0;
      const Placement place = anyPlacement(random, distance);
      const Scene scene = sceneOf(meshOf(family, random), place);
      const OccluderSet set = findOccluders(scene.view(), kKeepAll);
      for (const Occluder& occluder : set.occluders) {
        // In the occluder's own plane, where it differs from the one that the mesh was made in.
        Placement own;
        own.origin = Vec3d(set.verticesOf(occluder)[0]);
        own.x = normalized(cross(occluder.plane.normal, place.x + place.y * 0.3));
        own.y = cross(occluder.plane.normal, own.x);
        const std::vector<Point2> polygon = flattened(set, occluder, own);
        const double rounding = 1e-12 * distance + 1e-12;
        for (std::size_t i = 0; i + 2 < scene.indices.size(); i += 3) {
          std::array<Point2, 3> corners;
          Point2 middle;
          for (std::size_t k = 0; k < 3; ++k) {
            corners[k] = own.inverse(scene.positions[scene.indices[i + k]]);
            middle.x += corners[k].x / 3.0;
            middle.y += corners[k].y / 3.0;
          }
          if (depthIn(polygon, middle) <= 0.0) {
            continue;  // another polygon's
          }
          for (std::size_t k = 0; k < 3; ++k) {
            const Vec3f& corner = scene.positions[scene.indices[i + k]];
            EXPECT_LE(std::abs(occluder.plane.evaluate(Vec3d(corner))), occluder.slack + rounding)
                << about(family, seed, distance);
            EXPECT_LE(distanceBeyond(polygon, corners[k]), occluder.slack + rounding)
                << about(family, seed, distance);
          }
        }
      }
    }
  }
}

TEST(MergedPolygons, TwoTrianglesOfAQuadBecomeOne) {
  const OccluderSet set = findOccluders(sceneOf(rectangle(0, 0, 3, 2)).view());
  ASSERT_EQ(set.occluders.size(), 1u);
  EXPECT_EQ(set.occluders[0].vertex_count, 4u);
  EXPECT_FLOAT_EQ(set.occluders[0].area, 6.0f);
  EXPECT_EQ(set.occluders[0].centroid, Vec3f(1.5f, 1.0f, 0.0f));
  EXPECT_EQ(set.occluders[0].plane.normal, Vec3d(0, 0, 1));
  EXPECT_EQ(set.report.used, 2u);
}

TEST(MergedPolygons, AWallWithAWindowBecomesFourOrFive) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    Random random(seed);
    const FlatMesh mesh = grid({0, 1, 2, 3}, {0, 1, 2, 3}, random,
                               [](std::uint32_t c, std::uint32_t r) { return c != 1 || r != 1; });
    const OccluderSet set = findOccluders(sceneOf(mesh).view(), kKeepAll);
    EXPECT_GE(set.occluders.size(), 4u) << "seed " << seed;
    EXPECT_LE(set.occluders.size(), 5u) << "seed " << seed;
  }
}

TEST(MergedPolygons, AreFarFewerThanTheTrianglesOfALargeWall) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Random random(seed);
    const FlatMesh mesh =
        grid(steps(random, 16), steps(random, 16), random, [](std::uint32_t, std::uint32_t) { return true; });
    const OccluderSet set = findOccluders(sceneOf(mesh, anyPlacement(random, 50.0)).view(), kKeepAll);
    EXPECT_LE(set.occluders.size(), mesh.triangles.size() / 16) << "seed " << seed;
  }
}

// Pieces with long boundaries take turns to grow.
TEST(MergedPolygons, OfAVeryLongStripIsOne) {
  for (const std::uint32_t cells : {250u, 1030u, 3000u}) {
    FlatMesh strip;
    strip.add({0, 0});
    strip.add({0, 1});
    for (std::uint32_t i = 1; i <= cells; ++i) {
      const std::uint32_t next = strip.add({0.25 * i, 0});
      strip.add({0.25 * i, 1});
      strip.addQuad(next - 2, next, next + 1, next - 1, i % 3 == 0);
    }
    const OccluderSet set = findOccluders(sceneOf(strip).view());
    ASSERT_EQ(set.occluders.size(), 1u) << cells;
    EXPECT_EQ(set.occluders[0].area, 0.25f * static_cast<float>(cells));
    EXPECT_EQ(set.occluders[0].vertex_count, 4u);
  }
}

TEST(MergedPolygons, OfALongWallIsOne) {
  Random random(1);
  std::vector<double> xs, ys;
  for (int i = 0; i <= 300; ++i) {
    xs.push_back(i);
  }
  ys.assign(xs.begin(), xs.begin() + 41);
  const FlatMesh wall = grid(xs, ys, random, [](std::uint32_t, std::uint32_t) { return true; });
  EXPECT_EQ(findOccluders(sceneOf(wall).view()).occluders.size(), 1u);
}

TEST(MergedPolygons, OfOneMeshCannotBeMergedAnyFurther) {
  // No two of them share a whole side and are convex together.
  for (std::uint64_t seed = 1; seed <= test::rounds(40u); ++seed) {
    Random random(seed);
    const FlatMesh mesh = meshOf(seed % 2 == 0 ? Family::kHoles : Family::kFan, random);
    const OccluderSet set = findOccluders(sceneOf(mesh).view(), kKeepAll);
    for (std::size_t a = 0; a < set.occluders.size(); ++a) {
      for (std::size_t b = a + 1; b < set.occluders.size(); ++b) {
        const std::vector<Point2> p = flattened(set, set.occluders[a], {}),
                                  q = flattened(set, set.occluders[b], {});
        for (std::size_t i = 0; i < p.size(); ++i) {
          for (std::size_t j = 0; j < q.size(); ++j) {
            const Point2 &p0 = p[i], &p1 = p[(i + 1) % p.size()], &q0 = q[j], &q1 = q[(j + 1) % q.size()];
            if (p0.x != q1.x || p0.y != q1.y || p1.x != q0.x || p1.y != q0.y) {
              continue;
            }
            std::vector<Point2> both;
            for (std::size_t k = 1; k < p.size(); ++k) {
              both.push_back(p[(i + k) % p.size()]);
            }
            for (std::size_t k = 1; k < q.size(); ++k) {
              both.push_back(q[(j + k) % q.size()]);
            }
            EXPECT_FALSE(both.size() <= 16 && convexInSpace(both, 0.0)) << "seed " << seed;
          }
        }
      }
    }
  }
}

TEST(MergedPolygons, AFoldedSheetStaysTwo) {
  for (const double degrees : {0.5, 5.0, 90.0, 175.0}) {
    const double angle = degrees * std::numbers::pi / 180.0;
    Scene scene = sceneOf(rectangle(0, 0, 1, 1));
    // The quad 1 2 5 4 hinges on the edge from 1 to 2.
    const auto x = static_cast<float>(1.0 + std::cos(angle)), z = static_cast<float>(std::sin(angle));
    scene.positions.push_back({x, 0, z});
    scene.positions.push_back({x, 1, z});
    for (const std::uint32_t index : {1u, 4u, 5u, 1u, 5u, 2u}) {
      scene.indices.push_back(index);
    }
    scene.objects[0].index_count = 12;
    updateBounds(scene);
    EXPECT_EQ(findOccluders(scene.view(), kKeepAll).occluders.size(), 2u) << degrees << " degrees";
  }
}

TEST(MergedPolygons, SingleSidedTrianglesOfOppositeWindingAreNotMerged) {
  FlatMesh mesh = rectangle(0, 0, 1, 1);
  std::swap(mesh.triangles[1][1], mesh.triangles[1][2]);
  const OccluderSet set = findOccluders(sceneOf(mesh).view(), kKeepAll);
  ASSERT_EQ(set.occluders.size(), 2u);
  EXPECT_EQ(set.occluders[0].plane.normal.z, -set.occluders[1].plane.normal.z);
}

TEST(MergedPolygons, DoubleSidedTrianglesMergeWhateverTheirWinding) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    Random random(seed);
    FlatMesh mesh = meshOf(Family::kHoles, random);
    const Placement place = anyPlacement(random, 20.0);
    const std::size_t consistent =
        findOccluders(sceneOf(mesh, place, true).view(), kKeepAll).occluders.size();
    for (auto& triangle : mesh.triangles) {
      if (random.below(2) == 0) {
        std::swap(triangle[1], triangle[2]);
      }
    }
    const Scene scene = sceneOf(mesh, place, true);
    const OccluderSet set = findOccluders(scene.view(), kKeepAll);
    EXPECT_LE(set.occluders.size(), consistent + 3 + consistent / 2) << "seed " << seed;
    EXPECT_EQ(set.report.used, mesh.triangles.size()) << "seed " << seed;
    double area = 0.0;
    for (const Occluder& occluder : set.occluders) {
      EXPECT_TRUE(occluder.double_sided);
      area += occluder.area;
    }
    double expected = 0.0;
    for (const auto& t : mesh.triangles) {
      expected += 0.5 * std::abs(crossAt(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]));
    }
    EXPECT_NEAR(area, expected, 1e-4 * expected) << "seed " << seed;
  }
}

TEST(MergedPolygons, OfDifferentObjectsAreNotMerged) {
  Scene scene = sceneOf(rectangle(0, 0, 2, 1));
  addObject(scene, rectangle(2, 0, 4, 1), {}, MaterialId(0u));
  weldPositions(scene);
  const OccluderSet set = findOccluders(scene.view(), kKeepAll);
  ASSERT_EQ(set.occluders.size(), 2u);
  EXPECT_NE(set.occluders[0].object, set.occluders[1].object);
}

TEST(MergedPolygons, ThreeSheetsOnOneEdgeAllStay) {
  // Two coplanar halves and a fin that stands on their common edge.
  Scene scene = sceneOf(rectangle(0, 0, 1, 1));
  scene.positions.push_back({2, 0, 0});
  scene.positions.push_back({2, 1, 0});
  scene.positions.push_back({1, 0, 1});
  scene.positions.push_back({1, 1, 1});
  for (const std::uint32_t index : {1u, 4u, 5u, 1u, 5u, 2u, 1u, 2u, 7u, 1u, 7u, 6u}) {
    scene.indices.push_back(index);
  }
  scene.objects[0].index_count = 18;
  updateBounds(scene);
  const OccluderSet set = findOccluders(scene.view(), kKeepAll);
  EXPECT_EQ(set.report.used, 6u);
  EXPECT_NEAR(set.area, 3.0, 1e-6);
}

}  // namespace
}  // namespace sightline
