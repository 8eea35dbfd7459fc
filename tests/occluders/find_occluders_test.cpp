#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>

#include "scenes/procedural.h"
#include "tests/occluders/flat_mesh.h"
#include "tests/support/cut_work.h"
#include "tests/support/rounds.h"

namespace sightline {
namespace {

using namespace flat_mesh;

const Placement kBehind{{0, 0, -5}};

std::size_t countOf(const OccluderSet& set, ObjectId object) {
  return static_cast<std::size_t>(std::count_if(set.occluders.begin(), set.occluders.end(),
                                                [&](const Occluder& o) { return o.object == object; }));
}

bool sameSet(const OccluderSet& a, const OccluderSet& b) {
  const auto sameOccluder = [](const Occluder& p, const Occluder& q) {
    return p.first_vertex == q.first_vertex && p.vertex_count == q.vertex_count &&
           p.double_sided == q.double_sided && p.watertight_edges == q.watertight_edges &&
           p.object == q.object && p.area == q.area && p.slack == q.slack && p.centroid == q.centroid &&
           p.plane.normal == q.plane.normal && p.plane.offset == q.plane.offset;
  };
  const auto sameEdge = [](const OccluderEdge& p, const OccluderEdge& q) {
    return p.line == q.line && p.first_neighbour == q.first_neighbour &&
           p.neighbour_count == q.neighbour_count && p.mesh_edge_count == q.mesh_edge_count &&
           p.first_edge_vertex == q.first_edge_vertex;
  };
  const auto sameNeighbour = [](const EdgeNeighbour& p, const EdgeNeighbour& q) {
    return p.occluder == q.occluder && p.mesh_edge == q.mesh_edge;
  };
  return std::equal(a.occluders.begin(), a.occluders.end(), b.occluders.begin(), b.occluders.end(),
                    sameOccluder) &&
         std::equal(a.edges.begin(), a.edges.end(), b.edges.begin(), b.edges.end(), sameEdge) &&
         std::equal(a.neighbours.begin(), a.neighbours.end(), b.neighbours.begin(), b.neighbours.end(),
                    sameNeighbour) &&
         a.vertices == b.vertices && a.lines == b.lines && a.edge_vertices == b.edge_vertices &&
         a.body_of == b.body_of && a.body_vertices == b.body_vertices &&
         a.unit_of_object == b.unit_of_object && a.first_of_object == b.first_of_object &&
         a.of_object == b.of_object && a.area == b.area && reported(a.report) == reported(b.report) &&
         a.report.used == b.report.used;
}

TEST(FindOccluders, SeeThroughMaterialsAreNeverUsed) {
  for (const Opacity opacity : {Opacity::kBlended, Opacity::kAlphaTested}) {
    for (const OccluderMark mark : {OccluderMark::kAutomatic, OccluderMark::kOccluder}) {
      Scene scene = sceneOf(rectangle(0, 0, 1, 1));
      const ObjectId glass =
          addObject(scene, rectangle(0, 0, 90, 90), kBehind, addMaterial(scene, opacity), mark);
      const OccluderSet set = findOccluders(scene.view());
      EXPECT_EQ(set.occluders.size(), 1u);
      EXPECT_TRUE(set.occludersOf(glass).empty());
      EXPECT_EQ(set.report.see_through, 2u);
    }
  }
}

TEST(FindOccluders, ObjectsMarkedNeverAreNotUsed) {
  Scene scene = sceneOf(rectangle(0, 0, 1, 1));
  addObject(scene, rectangle(0, 0, 90, 90), kBehind, MaterialId(0u), OccluderMark::kNever);
  const OccluderSet set = findOccluders(scene.view());
  ASSERT_EQ(set.occluders.size(), 1u);
  EXPECT_EQ(set.occluders[0].object, ObjectId(0u));
  EXPECT_EQ(set.report.marked_never, 2u);
}

TEST(FindOccluders, ObjectsMarkedAsOccludersAreUsedHoweverSmall) {
  Scene scene = sceneOf(rectangle(0, 0, 100, 100));
  const ObjectId small = addObject(scene, rectangle(0, 0, 0.5, 0.5), kBehind, MaterialId(0u));
  const ObjectId marked =
      addObject(scene, rectangle(0, 0, 0.1, 0.1), kBehind, MaterialId(0u), OccluderMark::kOccluder);
  for (const OccluderSettings& settings : {OccluderSettings{}, OccluderSettings{.min_area = 50.0}}) {
    const OccluderSet set = findOccluders(scene.view(), settings);
    EXPECT_EQ(countOf(set, small), 0u);
    EXPECT_EQ(countOf(set, marked), 1u);
    EXPECT_EQ(set.report.too_small, 2u);
    EXPECT_EQ(set.report.used, 4u);
  }
}

TEST(FindOccluders, TheScaleOfTheSceneDoesNotChangeWhatIsLarge) {
  std::vector<std::size_t> counts;
  for (const double scale : {1e-4, 1.0, 1e4}) {
    Random random(3);
    Scene scene;
    const MaterialId material = addMaterial(scene);
    for (int i = 0; i < 200; ++i) {
      const double size = scale * std::exp2(random.in(-6.0, 3.0));
      addObject(scene, rectangle(0, 0, size, size), {random.point(10.0) * scale}, material);
    }
    counts.push_back(findOccluders(scene.view()).occluders.size());
  }
  EXPECT_LT(counts[1], 180u);
  EXPECT_GT(counts[1], 20u);
  EXPECT_EQ(counts[0], counts[1]);
  EXPECT_EQ(counts[2], counts[1]);
}

TEST(FindOccluders, RanksByAreaAndKeepsTheLargest) {
  Random random(9);
  Scene scene;
  const MaterialId material = addMaterial(scene);
  std::vector<float> areas;
  for (int i = 0; i < 60; ++i) {
    const double size = random.in(0.5, 4.0);
    addObject(scene, rectangle(0, 0, size, 1), anyPlacement(random, 5.0), material);
    areas.push_back(static_cast<float>(size));
  }
  std::sort(areas.begin(), areas.end(), std::greater<>());
  const OccluderSet all = findOccluders(scene.view(), kKeepAll);
  ASSERT_EQ(all.occluders.size(), areas.size());
  for (std::size_t i = 0; i < areas.size(); ++i) {
    EXPECT_NEAR(all.occluders[i].area, areas[i], 1e-4);
  }
  const OccluderSet ten = findOccluders(scene.view(), {.area_fraction = 1.0, .max_occluders = 10});
  ASSERT_EQ(ten.occluders.size(), 10u);
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_EQ(ten.occluders[i].object, all.occluders[i].object);
  }
  EXPECT_EQ(ten.report.too_small, 100u);
  const OccluderSet large = findOccluders(scene.view(), {.area_fraction = 1.0, .min_area = 2.0});
  EXPECT_EQ(large.occluders.size(), static_cast<std::size_t>(std::count_if(
                                        areas.begin(), areas.end(), [](float a) { return a >= 2.0f; })));
}

TEST(FindOccluders, KeepsTheLargestThatTogetherHaveTheWantedShareOfTheArea) {
  Scene scene;
  const MaterialId material = addMaterial(scene);
  for (const double width : {40.0, 30.0, 20.0, 10.0}) {
    addObject(scene, rectangle(0, 0, width, 1), {{0, 0, width}}, material);
  }
  const auto kept = [&](double fraction) {
    return findOccluders(scene.view(), {.area_fraction = fraction}).occluders.size();
  };
  EXPECT_EQ(kept(0.39), 1u);
  EXPECT_EQ(kept(0.41), 2u);
  EXPECT_EQ(kept(0.71), 3u);
  EXPECT_EQ(kept(0.89), 3u);
  EXPECT_EQ(kept(1.0), 4u);
  EXPECT_EQ(kept(0.0), 0u);
}

TEST(FindOccluders, DegenerateDoubledAndSliverTrianglesAreLeftOutAndCounted) {
  Scene scene = sceneOf(rectangle(0, 0, 4, 4));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  scene.positions.push_back({2, 0, 0});                           // 4: on the edge from 0 to 1
  scene.positions.push_back({2, std::nextafter(0.0f, 1.0f), 0});  // 5: hardly off it
  scene.positions.push_back({nan, 1, 0});                         // 6
  const std::vector<std::uint32_t> extra{0, 0, 1, 0, 1, 4, 0, 1, 5, 1, 2, 0, 0, 1, 2, 0, 1, 6, 3, 3, 3};
  scene.indices.insert(scene.indices.end(), extra.begin(), extra.end());
  scene.objects[0].index_count = static_cast<std::uint32_t>(scene.indices.size());
  for (const bool double_sided : {false, true}) {
    scene.materials[0].double_sided = double_sided;
    const OccluderSet set = findOccluders(scene.view(), kKeepAll);
    ASSERT_EQ(set.occluders.size(), 1u);
    EXPECT_FLOAT_EQ(set.occluders[0].area, 16.0f);
    EXPECT_EQ(set.occluders[0].vertex_count, 4u);
    EXPECT_EQ(set.report.used, 2u);
    EXPECT_EQ(set.report.degenerate, 7u);
  }
}

TEST(FindOccluders, AnObjectWithoutFiniteBoundsHasNone) {
  Scene scene = sceneOf(rectangle(0, 0, 4, 4));
  scene.objects[0].bounds.max.x = std::numeric_limits<float>::infinity();
  const OccluderSet set = findOccluders(scene.view());
  EXPECT_TRUE(set.occluders.empty());
  EXPECT_EQ(set.report.degenerate, 2u);
}

TEST(FindOccluders, OfAnEmptySceneAreNone) {
  const OccluderSet set = findOccluders(Scene{}.view());
  EXPECT_TRUE(set.occluders.empty());
  EXPECT_EQ(reported(set.report), 0u);
  EXPECT_TRUE(set.occludersOf(ObjectId(0u)).empty());
}

TEST(FindOccluders, TheReportAddsUpToAllTriangles) {
  for (const Scene& scene : {makeCity({.copies = 3}), makeBuilding({.floors = 2, .plants = 5})}) {
    for (const OccluderSettings& settings :
         {OccluderSettings{}, kKeepAll, OccluderSettings{.max_vertices = 4, .max_occluders = 100}}) {
      const OccluderSet set = findOccluders(scene.view(), settings);
      EXPECT_EQ(reported(set.report), scene.triangleCount());
      EXPECT_GT(set.report.used, 0u);
    }
  }
}

TEST(FindOccluders, ListsEachOccluderWithItsObject) {
  const Scene scene = makeBuilding({.floors = 1});
  const OccluderSet set = findOccluders(scene.view());
  std::size_t listed = 0;
  for (std::size_t object = 0; object < scene.objects.size(); ++object) {
    for (const OccluderId id : set.occludersOf(ObjectId(object))) {
      EXPECT_EQ(set[id].object, ObjectId(object));
      ++listed;
    }
  }
  EXPECT_EQ(listed, set.occluders.size());
}

TEST(FindOccluders, KeepsToTheirObjectsAndFacesForwardLikeItsTriangles) {
  const Scene scene = makeCity({.copies = 2});
  const OccluderSet set = findOccluders(scene.view());
  for (const Occluder& occluder : set.occluders) {
    const Object& object = scene.objects[occluder.object.value];
    EXPECT_NEAR(length(occluder.plane.normal), 1.0, 1e-12);
    const std::span<const Vec3f> corners = set.verticesOf(occluder);
    Vec3d normal;
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
      normal += cross(Vec3d(corners[i]) - Vec3d(corners[0]), Vec3d(corners[i + 1]) - Vec3d(corners[0]));
    }
    EXPECT_GT(dot(normal, occluder.plane.normal), 0.999 * length(normal));
    for (const Vec3f& corner : corners) {
      EXPECT_TRUE(contains(object.bounds, {corner, corner}));
      EXPECT_LE(std::abs(occluder.plane.evaluate(Vec3d(corner))), occluder.slack + 1e-12);
    }
  }
}

TEST(FindOccluders, DoNotDependOnHowTheWorkIsCut) {
  std::vector<Scene> scenes;
  scenes.push_back(makeBuilding({.floors = 2, .plants = 3}));
  scenes.push_back(makeBoxCity({.buildings = 3000, .boxes = 9000}));  // several parts of each step
  for (const Scene& scene : scenes) {
    const OccluderSet serial = findOccluders(scene.view());
    EXPECT_GT(serial.occluders.size(), 50u);
    for (const std::uint32_t step : {1u, 7u, 1000u}) {
      EXPECT_TRUE(sameSet(serial, findOccluders(scene.view(), {}, backwardsBy(step)))) << "step " << step;
    }
    EXPECT_TRUE(sameSet(serial, findOccluders(scene.view(), {}, onThreads(4))));
  }
}

// Tests of the neighbours of edges.

bool onLine(const std::array<Vec3f, 2>& line, const Vec3f& p, double tolerance) {
  const Vec3d a(line[0]), d = Vec3d(line[1]) - a;
  const Vec3d across = cross(d, Vec3d(p) - a);
  return length(across) <= tolerance * length(d);
}

// Describes each violation of these rules: corners lie on the lines of both edges that end there; each
// neighbour of an edge is an occluder that names this one in return, on the same line; the number of its mesh
// edge is below the edge's count.
std::string whatIsWrongWithLinks(const OccluderSet& set) {
  std::string wrong;
  for (std::size_t o = 0; o < set.occluders.size(); ++o) {
    const Occluder& occluder = set.occluders[o];
    const std::span<const OccluderEdge> edges = set.edgesOf(occluder);
    const std::span<const Vec3f> corners = set.verticesOf(occluder);
    for (std::size_t e = 0; e < edges.size(); ++e) {
      const OccluderEdge& edge = edges[e];
      const std::array<Vec3f, 2>& line = set.lines[edge.line];
      if (!onLine(line, corners[e], occluder.slack + 1e-9) ||
          !onLine(line, corners[(e + 1) % corners.size()], occluder.slack + 1e-9)) {
        wrong += "corner beside its line; ";
      }
      if (edge.mesh_edge_count == 0 && edge.neighbour_count != 0) {
        wrong += "neighbours without mesh edges; ";
      }
      for (const EdgeNeighbour& neighbour : set.neighboursOf(edge)) {
        if (neighbour.mesh_edge >= edge.mesh_edge_count) {
          wrong += "number beyond the mesh edges; ";
        }
        if (neighbour.occluder == OccluderId(o)) {
          wrong += "names itself; ";
        }
        const std::span<const OccluderEdge> others = set.edgesOf(set[neighbour.occluder]);
        if (std::none_of(others.begin(), others.end(), [&](const OccluderEdge& other) {
              const std::span<const EdgeNeighbour> back = set.neighboursOf(other);
              return other.line == edge.line &&
                     (!occluder.watertight_edges ||
                      std::any_of(back.begin(), back.end(),
                                  [&](const EdgeNeighbour& c) { return c.occluder == OccluderId(o); }));
            })) {
          wrong += "is not named in return; ";
        }
      }
    }
  }
  return wrong;
}

// Six faces, each a grid of n x n quads, in one object; vertices shared after welding.
Scene cube(std::uint32_t n, const Placement& place) {
  Scene scene;
  const MaterialId material = addMaterial(scene);
  const Vec3d x = place.x, y = place.y, z = cross(x, y);
  const Vec3d axes[6][2] = {{x, y}, {y, x}, {y, z}, {z, y}, {z, x}, {x, z}};
  Random random(n);
  std::vector<double> steps_along;
  for (std::uint32_t i = 0; i <= n; ++i) {
    steps_along.push_back(static_cast<double>(i) / n);
  }
  for (const auto& axis : axes) {
    const Vec3d normal = cross(axis[0], axis[1]);
    // Faces towards a positive axis lie at its far end.
    const bool far = dot(normal, x + y * 2.0 + z * 3.0) > 0.0;
    const FlatMesh mesh =
        grid(steps_along, steps_along, random, [](std::uint32_t, std::uint32_t) { return true; });
    addObject(scene, mesh, {place.origin + (far ? normal : Vec3d()), axis[0], axis[1]}, material);
  }
  scene.objects[0].index_count = static_cast<std::uint32_t>(scene.indices.size());
  scene.objects.resize(1);
  scene.object_names.resize(1);
  weldPositions(scene);
  updateBounds(scene);
  return scene;
}

TEST(OccluderEdges, OfACubeNameTheNeighbourForEachMeshEdge) {
  for (const std::uint32_t n : {1u, 2u, 8u}) {
    const OccluderSet set = findOccluders(cube(n, {}).view(), kKeepAll);
    ASSERT_EQ(set.occluders.size(), 6u) << n;
    EXPECT_EQ(whatIsWrongWithLinks(set), "") << n;
    EXPECT_EQ(set.lines.size(), 12u) << n;
    for (const Occluder& occluder : set.occluders) {
      EXPECT_TRUE(occluder.watertight_edges);
      for (const OccluderEdge& edge : set.edgesOf(occluder)) {
        EXPECT_EQ(edge.mesh_edge_count, n);
        ASSERT_EQ(edge.neighbour_count, n);
        for (std::uint32_t k = 0; k < n; ++k) {
          EXPECT_EQ(set.neighboursOf(edge)[k].mesh_edge, k);
          EXPECT_EQ(set.neighboursOf(edge)[k].occluder, set.neighboursOf(edge)[0].occluder);
        }
      }
    }
  }
}

TEST(OccluderEdges, OfATurnedCubeShareLinesWithinTheSlack) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    const OccluderSet set = findOccluders(cube(1, anyPlacement(random, 100.0)).view(), kKeepAll);
    EXPECT_EQ(whatIsWrongWithLinks(set), "") << "seed " << seed;
  }
}

TEST(OccluderEdges, NameADifferentNeighbourForEachPartOfAnEdge) {
  // A floor whose rear side is the foot of two walls of two objects, 0 to 1 and 1 to 2.
  FlatMesh floor;
  for (const Point2& p : {Point2{0, 0}, Point2{2, 0}, Point2{2, 3}, Point2{1, 3}, Point2{0, 3}}) {
    floor.add(p);
  }
  floor.triangles = {{0, 1, 3}, {1, 2, 3}, {0, 3, 4}};
  Scene scene = sceneOf(floor);
  const Placement upright{{0, 3, 0}, {1, 0, 0}, {0, 0, 1}};
  const ObjectId left = addObject(scene, rectangle(0, 0, 1, 2), upright, MaterialId(0u));
  const ObjectId right = addObject(scene, rectangle(1, 0, 2, 5), upright, MaterialId(0u));
  weldPositions(scene);
  const OccluderSet set = findOccluders(scene.view(), kKeepAll);
  ASSERT_EQ(set.occluders.size(), 3u);
  EXPECT_EQ(whatIsWrongWithLinks(set), "");
  const Occluder& ground = set[set.occludersOf(ObjectId(0u))[0]];
  ASSERT_EQ(ground.vertex_count, 4u);
  int divided = 0;
  for (const OccluderEdge& edge : set.edgesOf(ground)) {
    if (edge.mesh_edge_count != 2) {
      EXPECT_EQ(edge.neighbour_count, 0u);
      continue;
    }
    ++divided;
    ASSERT_EQ(edge.neighbour_count, 2u);
    // The side runs from x = 2 to x = 0.
    EXPECT_EQ(set[set.neighboursOf(edge)[0].occluder].object, right);
    EXPECT_EQ(set[set.neighboursOf(edge)[1].occluder].object, left);
  }
  EXPECT_EQ(divided, 1);
}

TEST(OccluderEdges, OfAWallCutIntoConvexPartsNameEachOther) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Random random(seed);
    const std::vector<double> xs = steps(random, 6), ys = steps(random, 6);
    const FlatMesh mesh = grid(
        xs, ys, random, [&](std::uint32_t c, std::uint32_t r) { return (c * 7 + r * 3 + seed) % 5 != 0; });
    const Placement place = anyPlacement(random, seed % 2 == 0 ? 1.0 : 200.0);
    const OccluderSet set = findOccluders(sceneOf(mesh, place).view(), kKeepAll);
    EXPECT_EQ(whatIsWrongWithLinks(set), "") << "seed " << seed;
    EXPECT_FALSE(set.neighbours.empty()) << "seed " << seed;
  }
}

// A wall on the middle of the upper side of another one, which then is as much higher.
OccluderSet wallsAtATJunction(float higher) {
  Scene scene = sceneOf(rectangle(0, 0, 4, 1.0f + higher));
  addObject(scene, rectangle(1, 1, 2, 2), {}, MaterialId(0u));
  weldPositions(scene);
  return findOccluders(scene.view(), kKeepAll);
}

// That of the edges of an occluder which has the most mesh edges.
const OccluderEdge& mostDivided(const OccluderSet& set, OccluderId id) {
  const std::span<const OccluderEdge> edges = set.edgesOf(set[id]);
  return *std::max_element(edges.begin(), edges.end(), [](const OccluderEdge& a, const OccluderEdge& b) {
    return a.mesh_edge_count < b.mesh_edge_count;
  });
}

TEST(OccluderEdges, NameEachOtherAtATJunction) {
  const OccluderSet set = wallsAtATJunction(0.0f);
  ASSERT_EQ(set.occluders.size(), 2u);
  EXPECT_EQ(whatIsWrongWithLinks(set), "");
  EXPECT_EQ(set.neighbours.size(), 2u);
  // The lower wall is the larger one.
  const OccluderEdge& lower = mostDivided(set, OccluderId(0u));
  EXPECT_EQ(lower.mesh_edge_count, 3u);
  ASSERT_EQ(lower.neighbour_count, 1u);
  EXPECT_EQ(set.neighboursOf(lower)[0].mesh_edge, 1u);
  EXPECT_EQ(set.neighboursOf(lower)[0].occluder, OccluderId(1u));
  EXPECT_EQ(set[OccluderId(0u)].vertex_count, 4u);
}

TEST(OccluderEdges, OneUnitInTheLastPlaceOffATJunctionNameNobody) {
  EXPECT_TRUE(wallsAtATJunction(0x1p-23f).neighbours.empty());
  EXPECT_TRUE(wallsAtATJunction(-0x1p-24f).neighbours.empty());
}

struct WholeRectangle {
  int x0, y0, x1, y1;
};

// Cuts a rectangle in two, and these, until they are small or chance says so.
void cutAtRandom(const WholeRectangle& r, Random& random, std::vector<WholeRectangle>& parts) {
  const int width = r.x1 - r.x0, height = r.y1 - r.y0;
  if (std::max(width, height) < 3 || (width * height < 200 && random.below(5) == 0)) {
    parts.push_back(r);
  } else if (width > height) {
    const int x = r.x0 + 1 + static_cast<int>(random.below(static_cast<std::uint32_t>(width - 1)));
    cutAtRandom({r.x0, r.y0, x, r.y1}, random, parts);
    cutAtRandom({x, r.y0, r.x1, r.y1}, random, parts);
  } else {
    const int y = r.y0 + 1 + static_cast<int>(random.below(static_cast<std::uint32_t>(height - 1)));
    cutAtRandom({r.x0, r.y0, r.x1, y}, random, parts);
    cutAtRandom({r.x0, y, r.x1, r.y1}, random, parts);
  }
}

// Whole coordinates: what touches does so exactly. The oracle asks each rectangle whether a point is on its
// border.
TEST(OccluderEdges, OfAFloorCutIntoRectanglesNameWhatLiesBeyondEachPiece) {
  std::size_t pieces = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Random random(seed);
    std::vector<WholeRectangle> parts;
    cutAtRandom({0, 0, 32, 32}, random, parts);
    const Placement places[] = {{}, {{5, -3, 7}, {0, 1, 0}, {0, 0, 1}}, {{}, {0, 0, -1}, {-1, 0, 0}}};
    const Placement place = places[seed % 3];
    Scene scene;
    addMaterial(scene);
    for (const WholeRectangle& r : parts) {
      addObject(scene, rectangle(r.x0, r.y0, r.x1, r.y1), place, MaterialId(0u));
    }
    weldPositions(scene);
    const OccluderSet set = findOccluders(scene.view(), kKeepAll);
    ASSERT_EQ(set.occluders.size(), parts.size()) << "seed " << seed;
    EXPECT_EQ(whatIsWrongWithLinks(set), "") << "seed " << seed;
    EXPECT_EQ(set.area, 32.0 * 32.0);
    const auto onBorder = [](const WholeRectangle& r, const Point2& p) {
      return depthIn(std::array<Point2, 4>{Point2(r.x0, r.y0), Point2(r.x1, r.y0), Point2(r.x1, r.y1),
                                           Point2(r.x0, r.y1)},
                     p) == 0.0;
    };
    for (const Occluder& occluder : set.occluders) {
      const std::span<const Vec3f> corners = set.verticesOf(occluder);
      ASSERT_EQ(corners.size(), 4u);
      for (std::size_t e = 0; e < 4; ++e) {
        const OccluderEdge& edge = set.edgesOf(occluder)[e];
        ASSERT_NE(edge.mesh_edge_count, 0u);
        std::vector<Vec3f> points{corners[e]};
        const std::span<const Vec3f> between =
            std::span(set.edge_vertices).subspan(edge.first_edge_vertex, edge.mesh_edge_count - 1u);
        points.insert(points.end(), between.begin(), between.end());
        points.push_back(corners[(e + 1) % 4]);
        for (std::uint32_t piece = 0; piece + 1 < points.size(); ++piece) {
          const Point2 middle = place.inverse((points[piece] + points[piece + 1]) * 0.5f);
          std::vector<ObjectId> beyond, named;
          for (std::size_t other = 0; other < parts.size(); ++other) {
            if (ObjectId(other) != occluder.object && onBorder(parts[other], middle)) {
              beyond.push_back(ObjectId(other));
            }
          }
          for (const EdgeNeighbour& neighbour : set.neighboursOf(edge)) {
            if (neighbour.mesh_edge == piece) {
              named.push_back(set[neighbour.occluder].object);
            }
          }
          EXPECT_EQ(named, beyond) << "seed " << seed << ", object " << occluder.object.value;
          pieces += beyond.size();
        }
      }
    }
  }
  EXPECT_GT(pieces, 5000u);
}

// Adds `count` walls side by side, from x = left on, each a metre wide but for the last, which ends at 128.
void addRowOfWalls(Scene& scene, std::uint32_t left, std::uint32_t count) {
  for (std::uint32_t i = 0; i < count; ++i) {
    addObject(scene, rectangle(left + i, 300, i + 1 < count ? left + i + 1 : 128, 302), {}, MaterialId(0u));
  }
}

TEST(OccluderEdges, OfTooManyPiecesStayWhole) {
  for (const std::uint32_t count : {64u, 65u}) {
    Scene scene = sceneOf(rectangle(0, 0, 128, 300));
    addRowOfWalls(scene, 0, count);
    weldPositions(scene);
    const OccluderSet set = findOccluders(scene.view(), kKeepAll);
    ASSERT_EQ(set.occluders.size(), count + 1);
    const OccluderEdge& upper = mostDivided(set, OccluderId(0u));
    EXPECT_EQ(upper.mesh_edge_count, count == 64 ? 64u : 1u);
    EXPECT_EQ(upper.neighbour_count, count == 64 ? 64u : 0u);
  }
}

// The upper side of the lower wall is two mesh edges long: one has a wall of its width on it, the other one
// many.
TEST(OccluderEdges, OfTooManyPiecesKeepWhatTheyShareAsAWhole) {
  for (const std::uint32_t count : {63u, 64u}) {
    FlatMesh lower;
    for (const Point2& p :
         {Point2{0, 0}, Point2{128, 0}, Point2{128, 300}, Point2{64, 300}, Point2{0, 300}}) {
      lower.add(p);
    }
    lower.triangles = {{0, 1, 3}, {1, 2, 3}, {0, 3, 4}};
    Scene scene = sceneOf(lower);
    addObject(scene, rectangle(0, 300, 64, 302), {}, MaterialId(0u));
    addRowOfWalls(scene, 64, count);
    weldPositions(scene);
    const OccluderSet set = findOccluders(scene.view(), kKeepAll);
    ASSERT_EQ(set.occluders.size(), count + 2);
    const OccluderEdge& upper = mostDivided(set, OccluderId(0u));
    EXPECT_EQ(upper.mesh_edge_count, count == 63 ? 64u : 2u);
    EXPECT_EQ(upper.neighbour_count, count == 63 ? 64u : 1u);
  }
}

// A third wall ends on the edge that two others share: it cancels there, and stays one edge.
TEST(OccluderEdges, ThatCancelAreNotDivided) {
  Scene scene = sceneOf(rectangle(0, 0, 4, 2));
  addObject(scene, rectangle(0, 2, 4, 5), {}, MaterialId(0u));
  addObject(scene, rectangle(1, 0, 2, 1), {{0, 2, 0}, {1, 0, 0}, {0, 0, 1}}, MaterialId(0u));
  weldPositions(scene);
  const OccluderSet set = findOccluders(scene.view(), kKeepAll);
  ASSERT_EQ(set.occluders.size(), 3u);
  std::size_t neighbours = 0;
  for (const OccluderEdge& edge : set.edges) {
    EXPECT_EQ(edge.mesh_edge_count, 1u);
    neighbours += edge.neighbour_count;
  }
  EXPECT_EQ(neighbours, 2u);
}

TEST(OccluderEdges, OfDemoScenesAreInOrder) {
  EXPECT_EQ(whatIsWrongWithLinks(findOccluders(makeCity({.copies = 2}).view())), "");
  EXPECT_EQ(whatIsWrongWithLinks(findOccluders(makeBuilding({.floors = 2}).view())), "");
}

// Occluders made from the caller's polygons.

std::size_t madeOf(const std::vector<Vec3f>& polygon) {
  const OccluderPolygon input[] = {{polygon, false, ObjectId(0u)}};
  return makeOccluders(input).occluders.size();
}

TEST(MakeOccluders, TakesConvexPlanarPolygons) {
  EXPECT_EQ(madeOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), 1u);
  EXPECT_EQ(madeOf({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}), 1u);
  EXPECT_EQ(madeOf({{0, 0, 0}, {0.5f, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}), 1u) << "a vertex on a side";
}

TEST(MakeOccluders, LeavesOutWhatIsNotConvexOrNotPlanarOrHasNoArea) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  EXPECT_EQ(madeOf({}), 0u);
  EXPECT_EQ(madeOf({{0, 0, 0}, {1, 0, 0}}), 0u);
  EXPECT_EQ(madeOf({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}), 0u);
  EXPECT_EQ(madeOf({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}), 0u);
  EXPECT_EQ(madeOf({{0, 0, 0}, {4, 0, 0}, {1, 1, 0}, {0, 4, 0}}), 0u) << "an arrowhead";
  EXPECT_EQ(madeOf({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {2, 3.99f, 0}, {0, 4, 0}}), 0u) << "slightly dented";
  EXPECT_EQ(madeOf({{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 3, 0}}), 0u) << "a bow tie";
  EXPECT_EQ(madeOf({{0, 0, 0}, {1, 0, 0}, {1, 1, 0.01f}, {0, 1, 0}}), 0u) << "warped";
  EXPECT_EQ(madeOf({{0, 0, 0}, {1, 0, 0}, {nan, 1, 0}}), 0u);
  EXPECT_EQ(madeOf({{0, 0, 0}, {1, 0, 0}, {inf, 1, 0}}), 0u);
  std::vector<Vec3f> pentagram, twice_round;
  for (int i = 0; i < 5; ++i) {
    const double angle = 2.0 * 6.283185307179586 * i / 5;
    pentagram.push_back({static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)), 0});
  }
  for (int i = 0; i < 8; ++i) {
    twice_round.push_back({i % 4 == 0 || i % 4 == 3 ? 0.0f : 1.0f, i % 4 < 2 ? 0.0f : 1.0f, 0});
  }
  EXPECT_EQ(madeOf(pentagram), 0u);
  EXPECT_EQ(madeOf(twice_round), 0u);
}

TEST(MakeOccluders, LeavesOutASideThatRunsBackAlongItself) {
  // Within the tolerance of its line, a side goes on to x = 4, back to where it turns, and on again. Between
  // its parts is a slit that can be seen through.
  const float width = 1.2e-5f;
  const auto made = [&](float on, float back) {
    return madeOf(
        {{0, 0, -8}, {on, 0, -8}, {back, 0.5f * width, -8}, {10, width, -8}, {10, 10, -8}, {0, 10, -8}});
  };
  EXPECT_EQ(made(4, 5), 1u) << "no way back";
  EXPECT_EQ(made(4, 2.5f), 0u);
  EXPECT_EQ(made(4, 3.999f), 0u);
  EXPECT_EQ(made(11, 9), 0u) << "beyond the next corner";
  EXPECT_EQ(made(4, -1), 0u) << "behind the corner before";
}

TEST(MakeOccluders, CountsWhatItLeavesOutAndKeepsTheRest) {
  const std::vector<Vec3f> good{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, larger{{0, 0, 1}, {3, 0, 1}, {0, 3, 1}},
      bad{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  const OccluderPolygon input[] = {
      {good, true, ObjectId(2u)}, {bad, false, ObjectId(5u)}, {larger, false, ObjectId(1u)}};
  const OccluderSet set = makeOccluders(input);
  ASSERT_EQ(set.occluders.size(), 2u);
  EXPECT_EQ(set.occluders[0].object, ObjectId(1u)) << "largest first";
  EXPECT_FALSE(set.occluders[0].double_sided);
  EXPECT_TRUE(set.occluders[1].double_sided);
  EXPECT_EQ(set.occludersOf(ObjectId(2u)).size(), 1u);
  EXPECT_TRUE(set.occludersOf(ObjectId(5u)).empty());
  EXPECT_EQ(set.report.degenerate, 1u);
}

TEST(MakeOccluders, TakesObjectsOfAnyNumberAndOfNone) {
  const std::vector<Vec3f> wall{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const ObjectId far_off(4'000'000'000u), last(0xfffffffeu);
  const OccluderPolygon input[] = {{wall, false, far_off},
                                   {wall, false, ObjectId()},
                                   {wall, false, ObjectId(7u)},
                                   {wall, false, last},
                                   {wall, false, far_off}};
  const OccluderSet set = makeOccluders(input);
  EXPECT_EQ(set.occluders.size(), 5u);
  EXPECT_LE(set.first_of_object.capacity() + set.first_unit_of_object.capacity(), 64u);
  EXPECT_EQ(set.occludersOf(far_off).size(), 2u);
  EXPECT_EQ(set.unitsOf(far_off).size(), 2u);
  EXPECT_EQ(set.occludersOf(ObjectId(7u)).size(), 1u);
  EXPECT_EQ(set.occludersOf(last).size(), 1u);
  for (const ObjectId other :
       {ObjectId(), ObjectId(0u), ObjectId(3u), ObjectId(8u), ObjectId(4'000'000'001u)}) {
    EXPECT_TRUE(set.occludersOf(other).empty()) << other.value;
    EXPECT_TRUE(set.unitsOf(other).empty()) << other.value;
  }
  for (const ObjectId object : {far_off, ObjectId(7u), last}) {
    for (const OccluderId id : set.occludersOf(object)) {
      EXPECT_EQ(set[id].object, object);
    }
  }
}

TEST(MakeOccluders, MakesSharedEdgesOfEqualEndsWatertight) {
  const std::vector<Vec3f> left{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
      right{{1, 0, 0}, {2, 0, 1}, {2, 1, 1}, {1, 1, 0}}, disjoint{{5, 0, 0}, {6, 0, 0}, {6, 1, 0}, {5, 1, 0}};
  const OccluderPolygon input[] = {
      {left, false, ObjectId(0u)}, {right, false, ObjectId(1u)}, {disjoint, false, ObjectId(2u)}};
  const OccluderSet set = makeOccluders(input);
  ASSERT_EQ(set.occluders.size(), 3u);
  EXPECT_EQ(whatIsWrongWithLinks(set), "");
  EXPECT_EQ(set.neighbours.size(), 2u);
}

// Walls around one edge, each of which has a second edge with a wall of its own beyond it.
OccluderSet wallsAroundOneEdge(std::size_t count) {
  std::vector<std::array<Vec3f, 4>> corners;
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = 6.283 * static_cast<double>(i) / static_cast<double>(count);
    const auto x = static_cast<float>(std::cos(angle)), y = static_cast<float>(std::sin(angle));
    corners.push_back({Vec3f{0, 0, 0}, {0, 0, 1}, {x, y, 1}, {x, y, 0}});
    corners.push_back({Vec3f{x, y, 0}, {x, y, 1}, {3 * x, 2 * y, 1}, {3 * x, 2 * y, 0}});
  }
  std::vector<OccluderPolygon> polygons;
  for (const std::array<Vec3f, 4>& of : corners) {
    polygons.push_back({of, true, ObjectId(0u)});
  }
  return makeOccluders(polygons);
}

TEST(MakeOccluders, LeavesAnEdgeOfTooManyPolygonsOpen) {
  // The limit is 64 polygons: all of them have neighbours there, or none has. Other edges are as they were.
  for (const std::size_t count : {2u, 63u, 64u, 65u, 200u}) {
    const OccluderSet set = wallsAroundOneEdge(count);
    ASSERT_EQ(set.occluders.size(), 2 * count);
    EXPECT_EQ(set.neighbours.size(), 2 * count + (count <= 64 ? count * (count - 1) : 0)) << count;
    EXPECT_EQ(whatIsWrongWithLinks(set), "") << count;
  }
}

TEST(MakeOccluders, TakesManyPolygonsInOnePlace) {
  // If each were the neighbour of all others, this would take more memory than there is.
  const std::vector<Vec3f> wall{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const OccluderSet set = makeOccluders(std::vector<OccluderPolygon>(100000, {wall, true, ObjectId(0u)}));
  EXPECT_EQ(set.occluders.size(), 100000u);
  EXPECT_TRUE(set.neighbours.empty());
}

TEST(MakeOccluders, NeverCoversMoreThanTheCallersPolygon) {
  // Random loops, most of them neither convex nor simple: what is accepted is what was given, and convex.
  int accepted = 0;
  for (std::uint64_t seed = 1; seed <= test::rounds(20000u); ++seed) {
    Random random(seed);
    const Placement place = anyPlacement(random, 5.0);
    std::vector<Vec3f> loop;
    std::vector<Point2> flat;
    for (std::uint32_t i = 0; i < 3 + seed % 4; ++i) {
      flat.push_back({static_cast<double>(random.below(4)), static_cast<double>(random.below(4))});
      loop.push_back(place(flat.back()));
    }
    const OccluderPolygon input[] = {{loop, true, ObjectId(0u)}};
    const OccluderSet set = makeOccluders(input);
    if (set.occluders.empty()) {
      continue;
    }
    ++accepted;
    // The reference: winding of points off the lattice's lines and diagonals.
    const std::vector<Point2> polygon = flattened(set, set.occluders[0], place);
    for (int s = 0; s < 12; ++s) {
      const Point2 p{random.in(-0.5, 3.5), random.in(-0.5, 3.5)};
      int winding = 0;
      for (std::size_t i = 0; i < flat.size(); ++i) {
        const Point2 &a = flat[i], &b = flat[(i + 1) % flat.size()];
        if ((a.y <= p.y) != (b.y <= p.y)) {
          const double side = crossAt(a, b, p);
          winding += a.y <= p.y && side > 0.0 ? 1 : a.y > p.y && side < 0.0 ? -1 : 0;
        }
      }
      std::vector<Point2> front(polygon.begin(), polygon.end());
      if (areaOf(front) < 0.0) {
        std::reverse(front.begin(), front.end());
      }
      if (depthIn(front, p) > 1e-4) {
        EXPECT_EQ(std::abs(winding), 1) << "seed " << seed;
      }
    }
  }
  EXPECT_GT(accepted, test::rounds(2000));
}

}  // namespace
}  // namespace sightline
