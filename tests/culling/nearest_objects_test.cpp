#include "src/culling/nearest_objects.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "sightline/scene/camera.h"
#include "tests/culling/fake_sets.h"
#include "tests/support/random_numbers.h"

namespace sightline::culling {
namespace {

using test::Random;

std::vector<Box> boxesAround(Random& random, std::size_t count) {
  std::vector<Box> boxes(count);
  for (Box& box : boxes) {
    box.extend(Vec3f(random.point(50.0)));
    box.extend(box.min + Vec3f(2, 1, 3));
  }
  return boxes;
}

double distanceOf(const Box& box, const Vec3d& eye) {
  Vec3d nearest;
  for (int axis = 0; axis < 3; ++axis) {
    nearest[axis] = std::clamp(eye[axis], double{box.min[axis]}, double{box.max[axis]});
  }
  return length(nearest - eye);
}

std::vector<ObjectId> inFrustum(const Frustum& frustum, std::span<const Box> boxes) {
  std::vector<ObjectId> inside;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    std::uint8_t planes = kAllFrustumPlanes;
    if (classify(frustum, boxes[i], planes) != FrustumSide::kOutside) {
      inside.push_back(ObjectId(i));
    }
  }
  return inside;
}

class NearestObjectsOf : public ::testing::TestWithParam<HierarchyKind> {};

TEST_P(NearestObjectsOf, AsManyAsThereAreAreThoseInTheFrustum) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Random random(seed);
    const std::vector<Box> boxes = boxesAround(random, 500);
    const Hierarchy hierarchy = buildHierarchy(boxes, {}, {.kind = GetParam()});
    View view;
    setOrientation(view, random.point(1.0), {0, 1, 0});
    const Frustum frustum = frustumOf(view);
    const std::vector<ObjectId> expected = inFrustum(frustum, boxes);
    NearestObjects nearest(hierarchy, boxes);
    for (int again = 0; again < 2; ++again) {
      std::vector<ObjectId> found;
      EXPECT_TRUE(nearest.find(frustum, view.eye, nullptr, 501, found));
      EXPECT_EQ(found, expected) << "seed " << seed;
    }
  }
}
TEST_P(NearestObjectsOf, ASetAreThoseOfTheSetInTheFrustum) {
  Random random(5);
  const std::vector<Box> boxes = boxesAround(random, 500);
  const Hierarchy hierarchy = buildHierarchy(boxes, {}, {.kind = GetParam()});
  fake_sets::FakeSets sets(boxes);
  SetFilter filter(hierarchy, boxes, &sets, SetFilter::Marks::kAll);
  std::vector<bool> members(boxes.size());
  for (std::size_t i = 0; i < members.size(); ++i) {
    members[i] = boxes[i].min.x < 0.0f;
  }
  sets.use(1, members);
  const View view;
  filter.find(view);
  std::vector<ObjectId> expected = inFrustum(frustumOf(view), boxes);
  const std::size_t all = expected.size();
  std::erase_if(expected, [&](ObjectId object) { return !filter.hasObject(object); });
  ASSERT_LT(expected.size(), all);
  ASSERT_FALSE(expected.empty());
  std::vector<ObjectId> found;
  EXPECT_TRUE(NearestObjects(hierarchy, boxes).find(frustumOf(view), view.eye, &filter, 501, found));
  EXPECT_EQ(found, expected);
}

INSTANTIATE_TEST_SUITE_P(Hierarchies, NearestObjectsOf,
                         ::testing::Values(HierarchyKind::kBvh, HierarchyKind::kKdTree));

TEST(NearestObjects, FewerAreNearerThanAllThatAreLeftOut) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Random random(seed);
    const std::vector<Box> boxes = boxesAround(random, 500);
    const Hierarchy hierarchy = buildHierarchy(boxes, {}, {.max_leaf_objects = 1});
    View view;
    setOrientation(view, random.point(1.0), {0, 1, 0});
    const Frustum frustum = frustumOf(view);
    std::vector<ObjectId> left = inFrustum(frustum, boxes);
    ASSERT_GT(left.size(), 20u);
    NearestObjects nearest(hierarchy, boxes);
    std::vector<ObjectId> found;
    EXPECT_FALSE(nearest.find(frustum, view.eye, nullptr, 12, found));
    EXPECT_EQ(found.size(), 12u);
    double farthest = 0.0;
    for (const ObjectId object : found) {
      EXPECT_EQ(std::erase(left, object), 1u) << "seed " << seed << ", object " << object.value;
      farthest = std::max(farthest, distanceOf(boxes[object.value], view.eye));
    }
    for (const ObjectId object : left) {
      EXPECT_GE(distanceOf(boxes[object.value], view.eye), farthest) << "seed " << seed;
    }
  }
}

TEST(NearestObjects, WithoutAFiniteBoxAreNearest) {
  Random random(3);
  std::vector<Box> boxes = boxesAround(random, 100);
  boxes[70].max.x = std::numeric_limits<float>::infinity();
  boxes[71].min.y = std::numeric_limits<float>::quiet_NaN();
  const Hierarchy hierarchy = buildHierarchy(boxes, {}, {});
  View view;
  std::vector<ObjectId> found;
  NearestObjects(hierarchy, boxes).find(frustumOf(view), view.eye, nullptr, 2, found);
  EXPECT_TRUE(std::ranges::find(found, ObjectId(70u)) != found.end());
  EXPECT_TRUE(std::ranges::find(found, ObjectId(71u)) != found.end());
}

TEST(NearestObjects, OfNoneAreNone) {
  std::vector<ObjectId> found;
  const Hierarchy hierarchy = buildHierarchy({}, {}, {});
  EXPECT_TRUE(NearestObjects(hierarchy, {}).find(frustumOf(View()), {}, nullptr, 5, found));
  EXPECT_TRUE(found.empty());
}

}  // namespace
}  // namespace sightline::culling
