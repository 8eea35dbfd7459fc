#include "sightline/scene/object_boxes.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <random>
#include <utility>

#include "src/scene/like_objects.h"
#include "tests/support/cut_off.h"
#include "tests/support/cut_work.h"
#include "tests/support/instruction_sets.h"
#include "tests/support/rounds.h"

namespace sightline {
namespace {

// A scene of one object after the other.
struct Shapes {
  Scene scene;

  void addTriangle(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
    for (const Vec3f& corner : {a, b, c}) {
      scene.indices.push_back(static_cast<std::uint32_t>(scene.positions.size()));
      scene.positions.push_back(corner);
    }
  }
  void addCuboid(const Box& box) {
    const auto corner = [&](int i) {
      return Vec3f(i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y,
                   i & 4 ? box.max.z : box.min.z);
    };
    constexpr int kFaces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                  {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& f : kFaces) {
      addTriangle(corner(f[0]), corner(f[1]), corner(f[2]));
      addTriangle(corner(f[0]), corner(f[2]), corner(f[3]));
    }
  }
  // coordinate() gives the next one.
  template <typename Coordinate>
  void addTriangles(int count, const Coordinate& coordinate) {
    const auto corner = [&] {
      const float x = coordinate(), y = coordinate(), z = coordinate();
      return Vec3f(x, y, z);
    };
    for (int t = 0; t < count; ++t) {
      const Vec3f a = corner(), b = corner(), c = corner();
      addTriangle(a, b, c);
    }
  }
  // Makes an object of what was added since the last call.
  void endObject() {
    Object object;
    object.first_index =
        scene.objects.empty() ? 0 : scene.objects.back().first_index + scene.objects.back().index_count;
    object.index_count = static_cast<std::uint32_t>(scene.indices.size()) - object.first_index;
    object.material = MaterialId(0u);
    scene.objects.push_back(object);
    scene.materials.resize(1);
    updateBounds(scene);
  }
};

Shapes shapeOf(std::initializer_list<Box> cuboids) {
  Shapes shapes;
  for (const Box& cuboid : cuboids) {
    shapes.addCuboid(cuboid);
  }
  shapes.endObject();
  return shapes;
}

std::vector<Box> boxesOf(const Shapes& shapes, const ObjectBoxesSettings& settings = {}) {
  const ObjectBoxes found = findObjectBoxes(shapes.scene.view(), settings);
  EXPECT_EQ(found.first.size(), shapes.scene.objects.size() + 1);
  const std::span<const Box> boxes = found.of(ObjectId(0u));
  return {boxes.begin(), boxes.end()};
}

bool holds(const Box& box, const Vec3d& p) {
  return p.x >= box.min.x && p.y >= box.min.y && p.z >= box.min.z && p.x <= box.max.x && p.y <= box.max.y &&
         p.z <= box.max.z;
}

// Points of all triangles, exact if coordinates have few bits, lie in the boxes; the boxes lie in the
// object's.
void expectHeld(const Shapes& shapes, const ObjectBoxes& found) {
  const SceneView scene = shapes.scene.view();
  for (std::uint32_t o = 0; o < scene.objects.size(); ++o) {
    const std::span<const Box> boxes = found.of(ObjectId(o));
    if (boxes.empty()) {
      continue;
    }
    ASSERT_GE(boxes.size(), 2u);
    ASSERT_LE(boxes.size(), kMaxObjectBoxes);
    for (const Box& box : boxes) {
      ASSERT_TRUE(box.wellFormed());
      ASSERT_TRUE(contains(scene.objects[o].bounds, box));
    }
    const std::span<const std::uint32_t> indices = scene.indicesOf(scene.objects[o]);
    constexpr int kSteps = 16;
    for (std::size_t i = 0; i < indices.size(); i += 3) {
      const Vec3d a(scene.positions[indices[i]]), b(scene.positions[indices[i + 1]]),
          c(scene.positions[indices[i + 2]]);
      for (int u = 0; u <= kSteps; ++u) {
        for (int v = 0; u + v <= kSteps; ++v) {
          const Vec3d p = (a * (kSteps - u - v) + b * u + c * v) * (1.0 / kSteps);
          ASSERT_TRUE(std::any_of(boxes.begin(), boxes.end(), [&](const Box& box) { return holds(box, p); }))
              << "object " << o << ", triangle " << i / 3 << ", (" << p.x << ", " << p.y << ", " << p.z
              << ")";
        }
      }
    }
  }
}

TEST(ObjectBoxes, ACuboidNeedsNoSecondBox) {
  EXPECT_TRUE(boxesOf(shapeOf({{{-1, -2, -3}, {4, 5, 6}}})).empty());
  EXPECT_TRUE(boxesOf(shapeOf({{{0, 0, 0}, {100, 0.5f, 3}}})).empty());
}

TEST(ObjectBoxes, AnLShapeHasTwo) {
  const std::vector<Box> boxes = boxesOf(shapeOf({{{0, 0, 0}, {2, 10, 4}}, {{2, 0, 0}, {10, 2, 4}}}));
  ASSERT_EQ(boxes.size(), 2u);
  EXPECT_EQ(surfaceArea(boxes[0]) + surfaceArea(boxes[1]),
            surfaceArea(Box{{0, 0, 0}, {2, 10, 4}}) + surfaceArea(Box{{2, 0, 0}, {10, 2, 4}}))
      << "the wings themselves";
}

TEST(ObjectBoxes, APanelOfTwoLayersIsAsFullAsOne) {
  // An L of three quarters of a square, with its back.
  Shapes panel;
  for (const Vec3f& at : {Vec3f(0, 0, 0), Vec3f(1, 0, 0), Vec3f(0, 1, 0)}) {
    const Vec3f b = at + Vec3f(1, 0, 0), c = at + Vec3f(1, 1, 0), d = at + Vec3f(0, 1, 0);
    panel.addTriangle(at, b, c);
    panel.addTriangle(at, c, d);
    panel.addTriangle(at, c, b);
    panel.addTriangle(at, d, c);
  }
  panel.endObject();
  EXPECT_EQ(boxesOf(panel).size(), 2u);
}

TEST(ObjectBoxes, AFaceInTheDividingPlaneBelongsToTheSideThatItBounds) {
  // A tower on a wide base and one under a wide roof: what divides best is the top of the base, and the
  // bottom of the roof, and each face in that plane would make the other box as wide as the whole.
  const Box base{{0, 0, 0}, {16, 16, 4}}, tower{{6, 6, 4}, {10, 10, 16}};
  EXPECT_EQ(boxesOf(shapeOf({base, tower})).size(), 2u);
  const Box roof{{0, 0, 12}, {16, 16, 16}}, column{{6, 6, 0}, {10, 10, 12}};
  EXPECT_EQ(boxesOf(shapeOf({roof, column})).size(), 2u);
}

TEST(ObjectBoxes, FindsWhatSavesOnlyAfterASecondDivision) {
  // A frame: no single plane leaves less than the whole on its two sides.
  const std::vector<Box> boxes =
      boxesOf(shapeOf({{{0, 0, 0}, {1, 1, 8}}, {{7, 0, 0}, {8, 1, 8}}, {{1, 0, 7}, {7, 1, 8}}}));
  EXPECT_GE(boxes.size(), 3u);
  const Vec3d opening(4.0, 0.5, 3.0);
  EXPECT_TRUE(std::none_of(boxes.begin(), boxes.end(), [&](const Box& box) { return holds(box, opening); }));
}

TEST(ObjectBoxes, DividesASingleTriangle) {
  // A beam across a diagonal, with no vertex within.
  Shapes shapes;
  shapes.addTriangle({0, 0, 0}, {64, 64, 64}, {64, 64, 63});
  shapes.endObject();
  const std::vector<Box> boxes = boxesOf(shapes);
  ASSERT_EQ(boxes.size(), kMaxObjectBoxes);
  double volume = 0.0;
  for (const Box& box : boxes) {
    const Vec3d e(box.extent());
    volume += e.x * e.y * e.z;
  }
  EXPECT_LT(volume, 64.0 * 64.0 * 64.0 / 16.0) << "eight cubes of an eighth of the length have a 64th";
  expectHeld(shapes, findObjectBoxes(shapes.scene.view()));
}

TEST(ObjectBoxes, KeepsToTheSettings) {
  Shapes shapes;
  shapes.addTriangle({0, 0, 0}, {64, 64, 64}, {64, 64, 63});
  shapes.endObject();
  for (std::uint32_t most = 2; most <= kMaxObjectBoxes; ++most) {
    EXPECT_EQ(boxesOf(shapes, {.max_boxes = most}).size(), most);
  }
  EXPECT_EQ(boxesOf(shapes, {.max_boxes = 100}).size(), kMaxObjectBoxes);
  EXPECT_TRUE(boxesOf(shapes, {.max_boxes = 1}).empty());
  EXPECT_TRUE(boxesOf(shapes, {.max_boxes = 0}).empty());
  EXPECT_TRUE(boxesOf(shapes, {.min_saving = 1.0}).empty());
}

TEST(ObjectBoxes, HoldAllOfRandomShapes) {
  std::size_t boxes = 0;
  for (std::uint32_t seed = 0; seed < test::rounds(60u); ++seed) {
    std::mt19937 random(seed);
    Shapes shapes;
    // Sixteenths up to 64, and triangles of any size: points in steps of a sixteenth of a side are exact.
    const auto coordinate = [&](int range) {
      return static_cast<float>(static_cast<int>(random() % static_cast<unsigned>(range)) - range / 2) /
             16.0f;
    };
    for (int o = 0; o < 6; ++o) {
      const int triangles = 1 + static_cast<int>(random() % 30);
      for (int t = 0; t < triangles; ++t) {
        const Vec3f at(coordinate(1024), coordinate(1024), coordinate(1024));
        const int size = 1 << (random() % 11);
        const auto corner = [&] { return at + Vec3f(coordinate(size), coordinate(size), coordinate(size)); };
        const Vec3f a = corner(), b = corner();
        shapes.addTriangle(a, b, random() % 8 == 0 ? a : corner());
      }
      shapes.endObject();
    }
    const ObjectBoxes found =
        findObjectBoxes(shapes.scene.view(), {.min_saving = seed % 2 == 0 ? 0.0 : 0.005});
    expectHeld(shapes, found);
    boxes += found.boxes.size();
  }
  EXPECT_GT(boxes, test::rounds(1000u));
}

// What of a polygon lies in no box: it is cut at the sides of one box after the other, each of which is wider
// by `slack` than it is, so that nothing may remain.
bool isCovered(std::vector<Vec3d> polygon, std::span<const Box> boxes, double slack) {
  if (boxes.empty()) {
    return false;
  }
  for (int side = 0; side < 6; ++side) {
    const int axis = side / 2;
    const auto depth = [&](const Vec3d& p) {  // in the box
      return side % 2 == 0 ? p[axis] - (boxes[0].min[axis] - slack) : boxes[0].max[axis] + slack - p[axis];
    };
    std::vector<Vec3d> inside, outside;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec3d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      const double da = depth(a), db = depth(b);
      (da >= 0.0 ? inside : outside).push_back(a);
      if ((da >= 0.0) != (db >= 0.0)) {
        const Vec3d crossing = a + (b - a) * (da / (da - db));
        inside.push_back(crossing);
        outside.push_back(crossing);
      }
    }
    if (!outside.empty() && !isCovered(std::move(outside), boxes.subspan(1), slack)) {
      return false;
    }
    if (inside.empty()) {
      return true;
    }
    polygon = std::move(inside);
  }
  return true;
}

TEST(ObjectBoxes, LeaveNoPartOfAMeshUncovered) {
  std::size_t boxes = 0;
  for (std::uint32_t seed = 0; seed < test::rounds(120u); ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> at(-50.0f, 50.0f), turn(-1.0f, 1.0f);
    Shapes shapes;
    // Sheets, tubes and spheres of many triangles, and soups of some; turned, so that nothing is parallel.
    const Vec3f u(turn(random), turn(random), turn(random)), v(turn(random), turn(random), turn(random)),
        w(turn(random), turn(random), turn(random));
    const int steps = 2 + static_cast<int>(random() % 24);
    const auto point = [&](int i, int j) {
      const float a = 6.2831853f * static_cast<float>(i) / static_cast<float>(steps);
      const float b = 3.1415927f * static_cast<float>(j) / static_cast<float>(steps);
      const float x = seed % 3 == 0 ? a : std::cos(a) * (seed % 3 == 1 ? 1.0f : std::sin(b));
      const float y = seed % 3 == 0 ? std::sin(a) : std::sin(a) * (seed % 3 == 1 ? 1.0f : std::sin(b));
      return u * (10.0f * x) + v * (10.0f * y) + w * (seed % 3 == 2 ? 20.0f * std::cos(b) : 8.0f * b);
    };
    for (int i = 0; i < steps; ++i) {
      for (int j = 0; j < steps; ++j) {
        shapes.addTriangle(point(i, j), point(i + 1, j), point(i + 1, j + 1));
        shapes.addTriangle(point(i, j), point(i + 1, j + 1), point(i, j + 1));
      }
    }
    shapes.endObject();
    shapes.addTriangles(1 + static_cast<int>(random() % 20), [&] { return at(random); });
    shapes.endObject();
    const SceneView scene = shapes.scene.view();
    const ObjectBoxes found = findObjectBoxes(scene, {.min_saving = seed % 2 == 0 ? 0.0 : 0.005});
    for (std::uint32_t o = 0; o < scene.objects.size(); ++o) {
      const std::span<const Box> of_object = found.of(ObjectId(o));
      const std::span<const std::uint32_t> indices = scene.indicesOf(scene.objects[o]);
      for (std::size_t i = 0; !of_object.empty() && i < indices.size(); i += 3) {
        const std::vector<Vec3d> triangle{Vec3d(scene.positions[indices[i]]),
                                          Vec3d(scene.positions[indices[i + 1]]),
                                          Vec3d(scene.positions[indices[i + 2]])};
        ASSERT_TRUE(isCovered(triangle, of_object, 1e-10)) << "seed " << seed << ", object " << o;
        EXPECT_FALSE(isCovered(triangle, {}, 1e-10));
      }
      EXPECT_TRUE(of_object.empty() || areBoxesOf(of_object, scene.objects[o].bounds));
    }
    boxes += found.boxes.size();
  }
  EXPECT_GT(boxes, test::rounds(1000u));
}

TEST(ObjectBoxes, LeaveNoPartOfASliverUncovered) {
  std::size_t boxes = 0;
  for (std::uint32_t seed = 0; seed < test::rounds(3000u); ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> at(-50.0f, 50.0f), along(0.0f, 1.0f);
    Shapes shapes;
    for (std::uint32_t t = 0; t < 1 + seed % 3; ++t) {
      // Corners on a line but for rounding, some of them next to each other, some in a plane across an axis.
      Vec3f a(at(random), at(random), at(random)), b(at(random), at(random), at(random));
      const int axis = static_cast<int>(random() % 4);
      if (axis < 3) {
        b[axis] = random() % 2 == 0 ? a[axis] : std::nextafter(a[axis], 100.0f);
      }
      Vec3f c = a + (b - a) * (random() % 4 == 0 ? 0.0f : along(random));
      c.y = random() % 2 == 0 ? c.y : std::nextafter(c.y, 100.0f);
      shapes.addTriangle(a, b, c);
    }
    shapes.endObject();
    const ObjectBoxes found = findObjectBoxes(shapes.scene.view(), {.min_saving = 0.0});
    const std::span<const Box> of_object = found.of(ObjectId(0u));
    for (std::size_t i = 0; !of_object.empty() && i < shapes.scene.indices.size(); i += 3) {
      const std::vector<Vec3d> triangle{Vec3d(shapes.scene.positions[i]),
                                        Vec3d(shapes.scene.positions[i + 1]),
                                        Vec3d(shapes.scene.positions[i + 2])};
      ASSERT_TRUE(isCovered(triangle, of_object, 1e-10)) << "seed " << seed;
    }
    boxes += of_object.size();
  }
  EXPECT_GT(boxes, test::rounds(10000u));
}

TEST(ObjectBoxes, EveryInstructionSetGivesTheSame) {
  std::mt19937 random(8);
  std::uniform_real_distribution<float> coordinate(-10.0f, 10.0f);
  Shapes shapes;
  for (int o = 0; o < 40; ++o) {
    shapes.addTriangles(1 + o, [&] { return coordinate(random); });
    shapes.endObject();
  }
  std::vector<ObjectBoxes> found;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    const test::ForcedInstructionSet forced(target);
    found.push_back(findObjectBoxes(shapes.scene.view()));
  }
  for (const ObjectBoxes& other : found) {
    EXPECT_EQ(found[0].first, other.first);
    EXPECT_EQ(found[0].boxes, other.boxes);
  }
}

TEST(ObjectBoxes, HoldTrianglesThatReachOneFloatBeyondAPlane) {
  for (std::uint32_t seed = 0; seed < 400; ++seed) {
    std::mt19937 random(seed);
    Shapes shapes;
    const auto coordinate = [&] {
      const float whole = 16.0f * static_cast<float>(1 + random() % 3);
      return random() % 2 == 0 ? whole : std::nextafter(whole, 100.0f);
    };
    const int triangles = 1 + static_cast<int>(random() % 12);
    shapes.addTriangles(triangles, coordinate);
    shapes.endObject();
    SCOPED_TRACE(seed);
    expectHeld(shapes, findObjectBoxes(shapes.scene.view(), {.min_saving = 0.0}));
  }
}

TEST(ObjectBoxes, ReachAllSidesOfTheObject) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> coordinate(-1e6f, 1e6f);
  Shapes shapes;
  for (int o = 0; o < 100; ++o) {
    shapes.addTriangles(5, [&] { return coordinate(random); });
    shapes.endObject();
  }
  const ObjectBoxes found = findObjectBoxes(shapes.scene.view());
  for (std::uint32_t o = 0; o < 100; ++o) {
    Box around;
    for (const Box& box : found.of(ObjectId(o))) {
      around.extend(box);
    }
    EXPECT_EQ(around, shapes.scene.objects[o].bounds);
  }
}

TEST(ObjectBoxes, OneBoxWhereThereIsNothingToDivide) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  Shapes shapes;
  shapes.endObject();  // without triangles
  shapes.addTriangle({1, 2, 3}, {1, 2, 3}, {1, 2, 3});
  shapes.endObject();
  shapes.addTriangle({0, 0, 0}, {64, 64, 64}, {64, nan, 63});
  shapes.endObject();
  shapes.addTriangle({0, 0, 0}, {64, 64, 64}, {64, 64, inf});
  shapes.endObject();
  const ObjectBoxes found = findObjectBoxes(shapes.scene.view());
  EXPECT_EQ(found.first, std::vector<std::uint32_t>(5, 0u));
  EXPECT_TRUE(found.boxes.empty());
  EXPECT_EQ(findObjectBoxes(SceneView{}).first, std::vector<std::uint32_t>(1, 0u));
}

TEST(ObjectBoxes, TakeTheLargestAndTheSmallestNumbers) {
  const float most = std::numeric_limits<float>::max(), least = std::numeric_limits<float>::denorm_min();
  for (const float size : {most, least * 4096.0f, 1.0f}) {
    Shapes shapes;
    shapes.addTriangle({-size, -size, -size}, {size, size, size}, {size, size, size * 0.75f});
    shapes.endObject();
    const ObjectBoxes found = findObjectBoxes(shapes.scene.view());
    for (const Box& box : found.boxes) {
      EXPECT_TRUE(box.wellFormed());
      EXPECT_TRUE(contains(shapes.scene.objects[0].bounds, box));
    }
    expectHeld(shapes, found);
    if (size < 2.0f) {
      EXPECT_EQ(found.boxes.size(), kMaxObjectBoxes) << size;
    }
  }
}

TEST(ObjectBoxes, DoNotDependOnTheThreads) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> coordinate(-10.0f, 10.0f);
  Shapes shapes;
  for (int o = 0; o < 50; ++o) {
    shapes.addTriangles(20, [&] { return coordinate(random); });
    shapes.endObject();
  }
  const ObjectBoxes serial = findObjectBoxes(shapes.scene.view());
  const ObjectBoxes other = findObjectBoxes(shapes.scene.view(), {}, backwardsBy(1));
  EXPECT_FALSE(serial.boxes.empty());
  EXPECT_EQ(serial.first, other.first);
  EXPECT_EQ(serial.boxes, other.boxes);
}

// Objects of triangles with few bits, three times each: as they are, far away, and far away with corners that
// are moved a little.
Shapes copiedShapes(std::mt19937& random) {
  std::uniform_int_distribution<int> place(-640, 640), nudge(-1, 1);
  Shapes shapes;
  for (int o = 0; o < 30; ++o) {
    std::array<float, 180> coordinates;
    for (float& coordinate : coordinates) {
      coordinate = static_cast<float>(place(random)) / 64.0f;
    }
    for (const auto& [offset, moved] : {std::pair(0.0f, 0), {256.0f, 0}, {-512.0f, 1}}) {
      std::size_t next = 0;
      shapes.addTriangles(20, [&] {
        return coordinates[next++] + offset + static_cast<float>(moved * nudge(random)) / 128.0f;
      });
      shapes.endObject();
    }
  }
  return shapes;
}

TEST(ObjectBoxes, OfCopiesAreDividedAlike) {
  std::mt19937 random(5);
  const Shapes shapes = copiedShapes(random);
  const ObjectBoxes found = findObjectBoxes(shapes.scene.view());
  expectHeld(shapes, found);
  std::size_t of_moved = 0;
  for (std::uint32_t o = 0; o < shapes.scene.objects.size(); o += 3) {
    const std::span<const Box> own = found.of(ObjectId(o)), copied = found.of(ObjectId(o + 1));
    ASSERT_EQ(own.size(), copied.size());
    for (std::size_t i = 0; i < own.size(); ++i) {
      const Vec3f offset(256.0f, 256.0f, 256.0f);
      EXPECT_LT(maxComponent(abs(own[i].min + offset - copied[i].min)), 1e-4f);
      EXPECT_LT(maxComponent(abs(own[i].max + offset - copied[i].max)), 1e-4f);
    }
    of_moved += found.of(ObjectId(o + 2)).size();
  }
  EXPECT_GT(of_moved, 60u);
}

TEST(LikeObjects, AreCopiesAndNothingElse) {
  std::mt19937 random(6);
  Shapes shapes = copiedShapes(random);
  const auto like = [&] { return scene::findLikeObjects(shapes.scene.view(), serialFor); };
  const std::vector<std::uint32_t> found = like();
  for (std::uint32_t o = 0; o < found.size(); o += 3) {
    EXPECT_EQ(found[o], o);
    EXPECT_EQ(found[o + 1], o);
    EXPECT_TRUE(found[o + 2] == o || found[o + 2] == o + 2) << found[o + 2];
  }
  // One corner of each copy within its box.
  for (std::uint32_t o = 1; o < found.size(); o += 3) {
    const Object& object = shapes.scene.objects[o];
    for (const std::uint32_t corner : shapes.scene.view().indicesOf(object)) {
      Vec3f& at = shapes.scene.positions[corner];
      const float most = 4.0f * scene::kLikeness * maxComponent(object.bounds.extent());
      if (at.x > object.bounds.min.x && at.x + most < object.bounds.max.x) {
        at.x += most;
        break;
      }
    }
  }
  const std::vector<std::uint32_t> after = like();
  for (std::uint32_t o = 0; o < found.size(); o += 3) {
    EXPECT_EQ(after[o + 1], o + 1);
  }
}

TEST(ObjectBoxes, AreReadAsTheyWereWrittenOrRefused) {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> coordinate(-10.0f, 10.0f);
  Shapes shapes;
  for (int o = 0; o < 20; ++o) {
    shapes.addTriangles(20, [&] { return coordinate(random); });
    shapes.endObject();
  }
  const ObjectBoxes boxes = findObjectBoxes(shapes.scene.view());
  const LargeVector<std::byte> bytes = objectBoxesBytes(boxes);
  const Result<ObjectBoxes> read = objectBoxesFrom(bytes, 20);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->first, boxes.first);
  EXPECT_EQ(read->boxes, boxes.boxes);
  EXPECT_FALSE(objectBoxesFrom(bytes, 21)) << "of another number of objects";
  test::expectCutOffIsRefused(bytes, "find them again",
                              [](std::span<const std::byte> cut) { return objectBoxesFrom(cut, 20); });
  const auto refuses = [&](auto&& change) {
    ObjectBoxes changed = boxes;
    change(changed);
    return !objectBoxesFrom(objectBoxesBytes(changed), 20);
  };
  EXPECT_FALSE(refuses([](ObjectBoxes&) {}));
  EXPECT_TRUE(refuses([](ObjectBoxes& b) { ++b.first.back(); }));
  EXPECT_TRUE(refuses([](ObjectBoxes& b) { std::swap(b.first[1], b.first[2]); }));
  EXPECT_TRUE(refuses([](ObjectBoxes& b) { b.boxes[0].max.y = b.boxes[0].min.y - 1.0f; }));
  EXPECT_TRUE(refuses([](ObjectBoxes& b) { b.first[1] = b.first[2] = b.first[3]; })) << "nine or more boxes";
}

}  // namespace
}  // namespace sightline
