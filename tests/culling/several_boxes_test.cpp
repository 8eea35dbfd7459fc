#include "src/culling/several_boxes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>

#include "sightline/culling/depth_pyramid_method.h"
#include "sightline/culling/frustum_method.h"
#include "tests/culling/demo_frames.h"

namespace sightline {
namespace {

using culling::SeveralBoxes;

// Says of each box what a function says, and counts the calls.
class Scripted final : public CullingMethod {
 public:
  explicit Scripted(std::function<Visibility(const Box&)> answer) : answer_(std::move(answer)) {}

  MethodTraits traits() const override { return {}; }
  void prepare(const CullingScene&) override {}
  void traverse(const CullingFrame&, CullStats&, std::vector<ObjectId>&) override {}
  void classify(std::span<const MovingBox> boxes, std::span<Visibility> states) override {
    asked += boxes.size();
    std::transform(boxes.begin(), boxes.end(), states.begin(),
                   [&](const MovingBox& box) { return answer_(box.box); });
  }

  std::size_t asked = 0;

 private:
  std::function<Visibility(const Box&)> answer_;
};

View ahead() {
  return {.eye = {0, -10, 0}, .right = {1, 0, 0}, .up = {0, 0, 1}, .forward = {0, 1, 0}};
}

Box cube(float x, float y, float z) {
  return {{x - 0.5f, y - 0.5f, z - 0.5f}, {x + 0.5f, y + 0.5f, z + 0.5f}};
}

// Objects of random boxes around the line of sight, each with its own box around them all.
struct RandomBoxes {
  ObjectBoxes boxes;
  std::vector<Box> bounds;

  explicit RandomBoxes(std::uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> coordinate(-12.0f, 12.0f);
    boxes.first.push_back(0);
    for (int o = 0; o < 100; ++o) {
      const auto count = static_cast<std::uint32_t>(random() % 5);
      Box around = cube(coordinate(random), coordinate(random), coordinate(random));
      for (std::uint32_t i = 0; count > 1 && i < count; ++i) {
        boxes.boxes.push_back(cube(coordinate(random), coordinate(random), coordinate(random)));
        around = i == 0 ? boxes.boxes.back() : around;
        around.extend(boxes.boxes.back());
      }
      boxes.first.push_back(static_cast<std::uint32_t>(boxes.boxes.size()));
      bounds.push_back(around);
    }
  }
};

TEST(SeveralBoxes, AnObjectGoesWhereAllOfItsBoxesAreHiddenOrOutside) {
  std::size_t gone = 0, stayed = 0;
  for (std::uint32_t seed = 0; seed < 50; ++seed) {
    const RandomBoxes objects(seed);
    SeveralBoxes several(objects.boxes, objects.bounds);
    std::mt19937 random(seed);
    // The same object in several frames: which box was seen last changes no answer.
    for (int frame = 0; frame < 5; ++frame) {
      const float limit = std::uniform_real_distribution<float>(-10.0f, 10.0f)(random);
      Scripted method([&](const Box& box) {
        return box.min.x < limit ? Visibility::kHidden
               : box.max.z > 0   ? Visibility::kPartial
                                 : Visibility::kVisible;
      });
      const Frustum frustum = frustumOf(ahead());
      std::vector<ObjectId> given, expected;
      for (std::uint32_t o = 0; o < 100; ++o) {
        if (random() % 4 == 0) {
          continue;
        }
        given.emplace_back(o);
        const std::span<const Box> boxes = objects.boxes.of(ObjectId(o));
        const bool seen = std::any_of(boxes.begin(), boxes.end(), [&](const Box& box) {
          std::uint8_t cut = kAllFrustumPlanes;
          return classify(frustum, box, cut) != FrustumSide::kOutside && !(box.min.x < limit);
        });
        if (boxes.empty() || seen) {
          expected.emplace_back(o);
        }
      }
      std::vector<ObjectId> kept = given;
      several.removeHidden(frustum, method, kept);
      ASSERT_EQ(kept, expected) << "seed " << seed << ", frame " << frame;
      gone += given.size() - kept.size();
      stayed += kept.size();
    }
  }
  EXPECT_GT(gone, 1000u);
  EXPECT_GT(stayed, 1000u);
}

TEST(SeveralBoxes, LooksFirstAtTheBoxThatWasSeenLast) {
  ObjectBoxes boxes{.first = {0, 3}, .boxes = {cube(-2, 0, 0), cube(0, 0, 0), cube(2, 0, 0)}};
  const std::vector<Box> bounds{{{-2.5f, -0.5f, -0.5f}, {2.5f, 0.5f, 0.5f}}};
  SeveralBoxes several(boxes, bounds);
  Scripted method(
      [](const Box& box) { return box.min.x > 1.0f ? Visibility::kVisible : Visibility::kHidden; });
  std::vector<ObjectId> kept{ObjectId(0u)};
  several.removeHidden(frustumOf(ahead()), method, kept);
  EXPECT_EQ(method.asked, 3u);
  several.removeHidden(frustumOf(ahead()), method, kept);
  EXPECT_EQ(method.asked, 4u);
  EXPECT_EQ(kept.size(), 1u);
}

// Says of each box what a function says. Sees the points that it told of boxes, as long as `sees`.
class Pointing final : public CullingMethod {
 public:
  MethodTraits traits() const override { return {}; }
  void prepare(const CullingScene&) override {}
  void traverse(const CullingFrame&, CullStats&, std::vector<ObjectId>&) override {}
  void classify(std::span<const MovingBox> boxes, std::span<Visibility> states) override {
    asked += boxes.size();
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      ASSERT_NE(boxes[i].seen_point, nullptr);
      EXPECT_TRUE(contains(boxes[i].box, Box{*boxes[i].seen_point, *boxes[i].seen_point}))
          << "the point of another box";
      states[i] = boxes[i].box.min.x > hidden_to ? Visibility::kPartial : Visibility::kHidden;
      if (states[i] == Visibility::kPartial) {
        *boxes[i].seen_point = boxes[i].box.max;
      }
    }
  }
  void seesPoints(std::span<const Vec3f> points, std::span<std::uint8_t> seen) const override {
    for (std::size_t i = 0; i < points.size(); ++i) {
      seen[i] = points[i].x > hidden_to + 1.0f ? 1 : 0;
    }
  }

  float hidden_to = 0.0f;
  std::size_t asked = 0;
};

TEST(SeveralBoxes, AreNotAskedWhereTheirPointIsStillSeen) {
  ObjectBoxes boxes{.first = {0, 3}, .boxes = {cube(-2, 0, 0), cube(0, 0, 0), cube(2, 0, 0)}};
  const std::vector<Box> bounds{{{-2.5f, -0.5f, -0.5f}, {2.5f, 0.5f, 0.5f}}};
  SeveralBoxes several(boxes, bounds);
  Pointing method;
  const auto keeps = [&](float hidden_to) {
    method.hidden_to = hidden_to;
    method.asked = 0;
    std::vector<ObjectId> kept{ObjectId(0u)};
    several.removeHidden(frustumOf(ahead()), method, kept);
    return !kept.empty();
  };
  EXPECT_TRUE(keeps(0.0f));
  EXPECT_EQ(method.asked, 3u) << "the first point is the centre of the first box";
  EXPECT_TRUE(keeps(0.1f));
  EXPECT_EQ(method.asked, 0u);
  EXPECT_FALSE(keeps(9.0f));
  EXPECT_EQ(method.asked, 3u);
  EXPECT_TRUE(keeps(-5.0f));
  EXPECT_EQ(method.asked, 0u);
}

TEST(SeveralBoxes, OthersThanTheObjectsAreNotUsed) {
  Scripted method([](const Box&) { return Visibility::kHidden; });
  const ObjectBoxes boxes{.first = {0, 2}, .boxes = {cube(-2, 0, 0), cube(2, 0, 0)}};
  const Box around{{-2.5f, -0.5f, -0.5f}, {2.5f, 0.5f, 0.5f}};
  const auto keeps = [&](const ObjectBoxes& given, const Box& bounds) {
    const std::vector<Box> all{bounds};
    SeveralBoxes several(given, all);
    std::vector<ObjectId> kept{ObjectId(0u)};
    several.removeHidden(frustumOf(ahead()), method, kept);
    return !kept.empty();
  };
  EXPECT_FALSE(keeps(boxes, around));
  Box larger = around;
  larger.max.z = 0.75f;
  EXPECT_TRUE(keeps(boxes, larger)) << "the object has grown";
  Box moved = around;
  moved.min.y += 3.0f;
  moved.max.y += 3.0f;
  EXPECT_TRUE(keeps(boxes, moved)) << "the object has moved";
  Box smaller = around;
  smaller.max.x = 1.0f;
  EXPECT_TRUE(keeps(boxes, smaller)) << "the object has shrunk, and may lie between its old boxes";
  EXPECT_TRUE(keeps(boxes, Box{})) << "the object has no box";
  EXPECT_TRUE(keeps({.first = {0, 1, 2}, .boxes = boxes.boxes}, around)) << "of two objects";
  EXPECT_TRUE(keeps({}, around)) << "of none";
  EXPECT_TRUE(keeps({.first = {0, 1}, .boxes = boxes.boxes}, around)) << "more boxes than rows name";
  EXPECT_TRUE(keeps({.first = {0, 3}, .boxes = boxes.boxes}, around)) << "fewer boxes than rows name";
  EXPECT_TRUE(keeps({.first = {1, 2}, .boxes = boxes.boxes}, around)) << "a first box before the first row";
  EXPECT_TRUE(keeps(
      {.first = {0, kMaxObjectBoxes + 1}, .boxes = std::vector<Box>(kMaxObjectBoxes + 1, around)}, around))
      << "too many";
  ObjectBoxes broken = boxes;
  broken.boxes[1].max.y = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(keeps(broken, around)) << "not a number";
}

// A wall, and behind it an object of two wings, all of which the wall hides but for the corner of the box
// between them.
struct WallAndWings {
  std::vector<Box> bounds{{{-4, 0, -4}, {2, 0.5f, 2}}, {{-3, 2, -3}, {3, 3, 3}}};
  ObjectBoxes boxes{.first = {0, 0, 2}, .boxes = {{{-3, 2, -3}, {3, 3, -2}}, {{-3, 2, -3}, {-2, 3, 3}}}};
  OccluderSet occluders;
  Hierarchy hierarchy = buildHierarchy(bounds, {});

  WallAndWings() {
    // Reaches over the ends of the wings, but not over the corner (3, 3).
    const std::vector<Vec3f> corners{{-9, 0, -9}, {9, 0, -9}, {9, 0, -6}, {-6, 0, 9}, {-9, 0, 9}};
    const OccluderPolygon wall{corners, true, ObjectId(0u)};
    occluders = makeOccluders({&wall, 1});
  }
};

TEST(SeveralBoxes, HideWhatOneBoxDoesNot) {
  const WallAndWings scene;
  for (const bool several : {false, true}) {
    const CullingScene culled{.hierarchy = &scene.hierarchy,
                              .object_bounds = scene.bounds,
                              .object_boxes = several ? &scene.boxes : nullptr,
                              .occluders = &scene.occluders};
    Culler pyramid(culled, depthPyramid());
    pyramid.cull(ahead());
    EXPECT_EQ(pyramid.visible().size(), several ? 1u : 2u);
    Culler untested(culled, depthPyramid(), {.test_objects = false});
    untested.cull(ahead());
    EXPECT_EQ(untested.visible().size(), 2u) << "whoever wants no tests of objects gets none of their boxes";
    Culler frustum(culled, frustumCulling());
    frustum.cull(ahead());
    EXPECT_EQ(frustum.visible().size(), 2u);
  }
}

TEST(SeveralBoxes, AllMethodsKeepNoMoreWithThem) {
  using namespace demo_frames;
  const DemoScene& demo = smallBuilding();
  const std::vector<View> views = demo.frames(demo.scene.paths[0], 40, 12);
  for (const NamedSettings& structure : kStructures) {
    AnySettings settings = structure.settings;
    AnyCuller one = demo.culler(HierarchyKind::kBvh, settings);
    settings.object_boxes = true;
    // Without a last frame both choose the same occluders.
    std::size_t of_one = 0, of_several = 0;
    for (const View& view : views) {
      AnyCuller several = demo.culler(HierarchyKind::kBvh, settings);
      one.reset();
      one.cull(view);
      several.cull(view);
      EXPECT_TRUE(std::includes(one.visible().begin(), one.visible().end(), several.visible().begin(),
                                several.visible().end()))
          << structure.name;
      of_one += one.visible().size();
      of_several += several.visible().size();
    }
    EXPECT_LT(of_several, of_one) << structure.name;
  }
}

}  // namespace
}  // namespace sightline
