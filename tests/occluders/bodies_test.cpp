// Convex bodies: which solids are found, and whether their faces, edges and vertices are consistent.

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "sightline/occluders/choose_occluders.h"
#include "tests/occluders/flat_mesh.h"
#include "tests/support/solids.h"

namespace sightline {
namespace {

using flat_mesh::kKeepAll;
using test::Solid;

// Solids in groups; each group is one object.
Scene sceneOf(const std::vector<std::vector<Solid>>& objects) {
  Scene scene;
  flat_mesh::addMaterial(scene);
  for (const std::vector<Solid>& solids : objects) {
    Object object;
    object.first_index = static_cast<std::uint32_t>(scene.indices.size());
    object.material = MaterialId(0u);
    for (const Solid& solid : solids) {
      const auto first = static_cast<std::uint32_t>(scene.positions.size());
      scene.positions.insert(scene.positions.end(), solid.points.begin(), solid.points.end());
      for (const std::vector<std::uint32_t>& face : solid.faces) {
        for (std::size_t i = 1; i + 1 < face.size(); ++i) {
          scene.indices.insert(scene.indices.end(), {first + face[0], first + face[i], first + face[i + 1]});
        }
      }
    }
    object.index_count = static_cast<std::uint32_t>(scene.indices.size()) - object.first_index;
    scene.objects.push_back(object);
    scene.object_names.emplace_back();
  }
  weldPositions(scene);
  updateBounds(scene);
  return scene;
}

OccluderSet found(const std::vector<std::vector<Solid>>& objects,
                  const OccluderSettings& settings = kKeepAll) {
  return findOccluders(sceneOf(objects).view(), settings);
}

OccluderSet made(const std::vector<std::vector<Solid>>& objects) {
  std::vector<std::vector<Vec3f>> vertices;
  std::vector<ObjectId> ids;
  for (std::size_t object = 0; object < objects.size(); ++object) {
    for (const Solid& solid : objects[object]) {
      for (std::size_t face = 0; face < solid.faces.size(); ++face) {
        vertices.push_back(solid.polygon(face));
        ids.push_back(ObjectId(object));
      }
    }
  }
  std::vector<OccluderPolygon> polygons;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    polygons.push_back({vertices[i], false, ids[i]});
  }
  return makeOccluders(polygons);
}

bool hasEdge(const OccluderSet& set, const OccluderBody& body, std::uint32_t face, const BodyEdge& edge,
             bool forwards) {
  const std::span<const Vec3f> points = set.verticesOf(body);
  const Vec3f &from = points[forwards ? edge.from : edge.to], &to = points[forwards ? edge.to : edge.from];
  const std::span<const Vec3f> polygon = set.verticesOf(set[set.facesOf(body)[face].occluder]);
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    if (polygon[i] == from && polygon[(i + 1) % polygon.size()] == to) {
      return true;
    }
  }
  return false;
}

// Checks the invariants of a body.
void expectSound(const OccluderSet& set, const OccluderBody& body) {
  const std::span<const Vec3f> points = set.verticesOf(body);
  const std::span<const BodyFace> faces = set.facesOf(body);
  EXPECT_EQ(points.size() + faces.size(), set.edgesOf(body).size() + 2) << "Euler";
  EXPECT_TRUE(std::ranges::is_sorted(faces, {}, [](const BodyFace& face) { return face.occluder; }));
  std::size_t corners = 0;
  for (const BodyFace& face : faces) {
    const Occluder& occluder = set[face.occluder];
    EXPECT_EQ(set.bodyOf(face.occluder), &body);
    EXPECT_EQ(face.plane.normal, occluder.plane.normal);
    EXPECT_EQ(face.plane.offset, occluder.plane.offset);
    EXPECT_GE(body.slack, occluder.slack);
    ASSERT_LT(face.vertex, points.size());
    EXPECT_TRUE(std::ranges::count(set.verticesOf(occluder), points[face.vertex]) == 1);
    corners += occluder.vertex_count;
    for (const Vec3f& point : points) {
      EXPECT_LE(face.plane.evaluate(Vec3d(point)), static_cast<double>(body.slack));
    }
  }
  EXPECT_EQ(corners, 2 * set.edgesOf(body).size());
  Box bounds;
  for (const Vec3f& point : points) {
    EXPECT_EQ(std::ranges::count(points, point), 1);
    bounds.extend(point);
  }
  EXPECT_EQ(bounds, body.bounds);
  for (const BodyEdge& edge : set.edgesOf(body)) {
    ASSERT_LT(edge.left, faces.size());
    ASSERT_LT(edge.right, faces.size());
    EXPECT_TRUE(hasEdge(set, body, edge.left, edge, true));
    EXPECT_TRUE(hasEdge(set, body, edge.right, edge, false));
  }
}

using Shape = std::tuple<std::size_t, std::size_t, std::size_t>;  // faces, edges, vertices
Shape shapeOf(const OccluderBody& body) {
  return {body.face_count, body.edge_count, body.vertex_count};
}

// Expects that the solid becomes exactly one body, of this shape.
void expectBody(const Solid& solid, const Shape& shape) {
  for (const OccluderSet& set : {found({{solid}}), made({{solid}})}) {
    ASSERT_EQ(set.bodies.size(), 1u);
    EXPECT_EQ(shapeOf(set.bodies[0]), shape);
    EXPECT_EQ(set.occluders.size(), std::get<0>(shape));
    expectSound(set, set.bodies[0]);
  }
}
void expectNoBody(const Solid& solid, std::size_t min_occluders) {
  for (const OccluderSet& set : {found({{solid}}), made({{solid}})}) {
    EXPECT_TRUE(set.bodies.empty());
    EXPECT_TRUE(set.body_faces.empty());
    EXPECT_GE(set.occluders.size(), min_occluders) << "or it says nothing";
    EXPECT_EQ(set.body_of.size(), set.occluders.size());
    for (std::size_t i = 0; i < set.occluders.size(); ++i) {
      EXPECT_EQ(set.bodyOf(OccluderId(i)), nullptr);
    }
  }
}

const Solid kCube = test::block({0, 0, 0}, {2, 3, 4});

TEST(Bodies, AClosedBoxIsOne) {
  expectBody(kCube, {6, 12, 8});
}

TEST(Bodies, OtherConvexSolidsAreToo) {
  expectBody(test::octahedron(), {8, 12, 6});
  expectBody(test::prism(6), {8, 18, 12});
  expectBody(test::prism(3), {5, 9, 6});
  expectBody(test::tetrahedron(), {4, 6, 4});
}

TEST(Bodies, ATurnedAndMovedSolidIsOneAlthoughItsCornersAreRounded) {
  flat_mesh::Random random(4);
  int bodies = 0;
  for (int i = 0; i < 40; ++i) {
    const flat_mesh::Placement place = flat_mesh::anyPlacement(random, i % 2 == 0 ? 5.0 : 1e4);
    const Solid solid = i % 4 < 2 ? kCube : test::prism(7);
    const OccluderSet set = found({{test::placed(solid, place.origin, place.x, place.y)}});
    bodies += static_cast<int>(set.bodies.size());
    for (const OccluderBody& body : set.bodies) {
      expectSound(set, body);
    }
  }
  EXPECT_GE(bodies, 36);
}

TEST(Bodies, ABoxOfSmallTrianglesIsOne) {
  // Each side is a grid; edges are chains of several mesh edges, the same from both sides.
  const Solid fine = test::dicedBlock({0, 0, 0}, {2, 3, 4}, 3);
  const OccluderSet set = found({{fine}});
  ASSERT_EQ(set.bodies.size(), 1u);
  EXPECT_EQ(shapeOf(set.bodies[0]), (Shape{6, 12, 8}));
  expectSound(set, set.bodies[0]);
}

TEST(Bodies, ABoxWithoutALidIsNone) {
  for (std::size_t side = 0; side < 6; ++side) {
    Solid open = kCube;
    open.faces.erase(open.faces.begin() + static_cast<std::ptrdiff_t>(side));
    expectNoBody(open, 5);
  }
}

TEST(Bodies, ARoomIsNone) {
  Solid room = kCube;
  for (std::vector<std::uint32_t>& face : room.faces) {
    std::ranges::reverse(face);
  }
  expectNoBody(room, 6);
}

TEST(Bodies, ABoxWithOneSideTurnedInsideOutIsNone) {
  Solid solid = kCube;
  std::ranges::reverse(solid.faces[2]);
  expectNoBody(solid, 6);
}

TEST(Bodies, AnLShapedSolidIsNone) {
  expectNoBody(test::lShape(), 6);
}

TEST(Bodies, ABoxWithAVertexOfOneSideAloneOnAnEdgeIsNone) {
  // The vertex in the middle of the edge from corner 0 to corner 1 is of one side only: rounding may open a
  // crack there.
  Solid cracked = kCube;
  cracked.points.push_back(Vec3f((Vec3d(cracked.points[0]) + Vec3d(cracked.points[1])) * 0.5));
  for (std::vector<std::uint32_t>& face : cracked.faces) {
    for (std::size_t i = 0; i < face.size(); ++i) {
      if (face[i] == 0 && face[(i + 1) % face.size()] == 1) {
        face.insert(face.begin() + static_cast<std::ptrdiff_t>(i) + 1, 8);
        // The fan starts where no triangle has all its corners on the edge.
        std::rotate(face.begin(), face.begin() + static_cast<std::ptrdiff_t>((i + 3) % face.size()),
                    face.end());
        expectNoBody(cracked, 6);
        return;
      }
    }
  }
  FAIL() << "no side has the edge";
}

// Two sheets back to back, of one outline with a notch, each cut in two elsewhere: all edges have a mate and
// no vertex lies before any plane, but nothing is enclosed and the outline is not convex.
TEST(Bodies, AFlatSheetWithANotchIsNone) {
  const OccluderSet set = made({{test::notchedSheet()}});
  ASSERT_EQ(set.occluders.size(), 4u);
  EXPECT_TRUE(set.bodies.empty());
}

TEST(Bodies, TwoBoxesOfOneObjectAreTwo) {
  const Solid disjoint = test::block({10, 0, 0}, {11, 1, 1});
  for (const OccluderSet& set : {found({{kCube, disjoint}}), made({{kCube, disjoint}})}) {
    ASSERT_EQ(set.bodies.size(), 2u);
    for (const OccluderBody& body : set.bodies) {
      EXPECT_EQ(shapeOf(body), (Shape{6, 12, 8}));
      expectSound(set, body);
    }
  }
}

// What is small beside the rounding of another object's corners is not flat for that.
TEST(Bodies, ABoxBesideAVastOneOfAnotherObjectIsOne) {
  const Solid vast = test::block({-1e6f, -1e6f, -1e6f}, {1e6f, 1e6f, -1e5f});
  for (const OccluderSet& set : {found({{kCube}, {vast}}), made({{kCube}, {vast}})}) {
    EXPECT_EQ(set.bodies.size(), 2u);
  }
}

TEST(Bodies, BoxesThatShareAnEdgeOfTheMeshAreNone) {
  // The edge belongs to four faces.
  const Solid beside = test::block({2, 3, 0}, {4, 6, 4});
  EXPECT_TRUE(found({{kCube, beside}}).bodies.empty());
  EXPECT_EQ(found({{kCube}, {beside}}).bodies.size(), 2u) << "of two objects each has edges of its own";
}

// A folded sheet of so many squares, from the edge between (0, 0, 0) and (0, 0, 4) on.
Solid foldedSheet(std::uint32_t squares) {
  Solid sheet;
  for (std::uint32_t i = 0; i <= squares; ++i) {
    const float x = static_cast<float>(i), y = i % 2 == 0 ? 0.0f : 0.5f;
    sheet.points.insert(sheet.points.end(), {{x, y, 0}, {x, y, 4}});
    if (i > 0) {
      sheet.faces.push_back({2 * i - 2, 2 * i - 1, 2 * i + 1, 2 * i});
    }
  }
  return sheet;
}

TEST(Bodies, ABoxOnAnEdgeOfALargeMeshOfItsObjectIsOne) {
  // No body has as many faces as the large mesh, so what it shares with the box says nothing of the box.
  const Solid box = test::block({-2, 0, 0}, {0, 3, 4});
  const OccluderSet large = found({{foldedSheet(33), box}});
  EXPECT_EQ(large.occluders.size(), 33u + 6u);
  ASSERT_EQ(large.bodies.size(), 1u);
  EXPECT_EQ(shapeOf(large.bodies[0]), (Shape{6, 12, 8}));
  expectSound(large, large.bodies[0]);
  EXPECT_TRUE(found({{foldedSheet(32), box}}).bodies.empty()) << "or they share no edge, and it says nothing";
}

TEST(Bodies, FacesOfABodyAreKeptTogetherHoweverSmall) {
  const Solid slab = test::block({0, 0, 0}, {40, 40, 0.1f});  // sides of 4 square metres, 0.1 % of all
  const Solid small = test::block({100, 0, 0}, {101, 1, 1});
  for (const OccluderSettings& settings :
       {OccluderSettings{.area_fraction = 0.98}, OccluderSettings{.area_fraction = 1.0, .min_area = 100.0}}) {
    const OccluderSet set = found({{slab}, {small}}, settings);
    ASSERT_EQ(set.bodies.size(), 1u);
    EXPECT_EQ(set.occluders.size(), 6u);
    EXPECT_EQ(set.occludersOf(ObjectId(0u)).size(), 6u);
    expectSound(set, set.bodies[0]);
    EXPECT_EQ(set.report.too_small, 12u);
  }
}

TEST(Bodies, OfWhichALimitCutsAFaceAreNone) {
  const Solid small = test::block({10, 0, 0}, {11, 1, 1});
  for (std::uint32_t limit = 1; limit <= 12; ++limit) {
    const OccluderSet set = found({{kCube}, {small}}, {.area_fraction = 1.0, .max_occluders = limit});
    EXPECT_EQ(set.occluders.size(), limit);
    EXPECT_EQ(set.bodies.size(), limit < 6 ? 0u : limit < 12 ? 1u : 2u) << limit;
    for (const OccluderBody& body : set.bodies) {
      expectSound(set, body);
    }
  }
}

TEST(Bodies, SolidsOfManyFacesAreNoneAndKeepTheirOccluders) {
  EXPECT_EQ(found({{test::prism(12)}}).bodies.size(), 1u);
  EXPECT_EQ(made({{test::prism(16)}}).bodies.size(), 1u);
  expectNoBody(test::prism(17), 17);  // 34 vertices
}

// Describes a body independently of the order of its parts.
using Corners = std::set<std::tuple<float, float, float>>;
std::multiset<std::pair<Corners, Shape>> contents(const OccluderSet& set) {
  std::multiset<std::pair<Corners, Shape>> all;
  for (const OccluderBody& body : set.bodies) {
    Corners corners;
    for (const Vec3f& p : set.verticesOf(body)) {
      corners.emplace(p.x, p.y, p.z);
    }
    all.emplace(corners, shapeOf(body));
  }
  return all;
}

TEST(Bodies, AreTheSameWhateverTheOrderOfTheObjectsAndOfTheirFaces) {
  std::mt19937_64 random(11);
  Solid lidless = test::block({50, 0, 0}, {53, 2, 2});
  lidless.faces.pop_back();
  std::vector<std::vector<Solid>> objects{{kCube, test::block({10, 0, 0}, {12, 3, 4})},
                                          {test::octahedron()},
                                          {test::lShape()},
                                          {lidless},
                                          {test::placed(test::prism(6), {30, 0, 0}, {1, 0, 0}, {0, 1, 0})}};
  const auto first = contents(found(objects));
  EXPECT_EQ(first.size(), 4u);
  for (int i = 0; i < 20; ++i) {
    std::ranges::shuffle(objects, random);
    for (std::vector<Solid>& object : objects) {
      std::ranges::shuffle(object, random);
      for (Solid& solid : object) {
        std::ranges::shuffle(solid.faces, random);
      }
    }
    EXPECT_EQ(contents(found(objects)), first) << "shuffle " << i;
    EXPECT_EQ(contents(made(objects)), first) << "shuffle " << i;
  }
}

TEST(Bodies, CountAsOneWhereTheyAreChosenAsOne) {
  const OccluderSet set = found({{kCube}, {test::block({10, 0, 0}, {12, 3, 4})}});
  View view;
  view.eye = {6, -30, 2};
  setOrientation(view, {0, 1, 0}, {0, 0, 1});
  std::vector<OccluderId> all;
  for (std::size_t i = 0; i < set.occluders.size(); ++i) {
    all.push_back(OccluderId(i));
  }
  OccluderChooser chooser;
  const ObjectId objects[] = {ObjectId(0u), ObjectId(1u)};
  const Box bounds[] = {set.bodies[0].bounds, set.bodies[1].bounds};
  const auto chosen = chooser.choose(view, set, objects, bounds, {.count = 64, .bodies = true});
  ASSERT_EQ(chosen.size(), 2u);
  EXPECT_NE(set.bodyOf(chosen[0]), set.bodyOf(chosen[1]));
  for (const OccluderId id : chosen) {
    EXPECT_EQ(set.facesOf(*set.bodyOf(id)).front().occluder, id);
  }
  EXPECT_EQ(chooser.choose(view, set, objects, bounds, {.count = 1, .bodies = true}).size(), 1u);
  EXPECT_GT(chooser.choose(view, set, objects, bounds, {.count = 64}).size(), 2u);
  EXPECT_GT(chooser.choose(view, set, all, {.count = 64, .bodies = true}).size(), 2u);
}

}  // namespace
}  // namespace sightline
