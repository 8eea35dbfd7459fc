// Hierarchies that are written as bytes and read again.

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "scenes/procedural.h"
#include "sightline/hierarchy/hierarchy.h"
#include "tests/support/cut_off.h"
#include "tests/support/object_arrays.h"

namespace sightline {
namespace {

struct CityHierarchy {
  Scene scene = *makeDemoScene("demo:city?copies=1");
  std::uint32_t objects = static_cast<std::uint32_t>(scene.objects.size());

  Hierarchy build(HierarchyKind kind) const {
    return buildHierarchy(test::boxesOf(scene.objects), {}, {.kind = kind});
  }
};

TEST(HierarchyBytes, AreReadAsTheyWereWritten) {
  const CityHierarchy city;
  for (const HierarchyKind kind : {HierarchyKind::kBvh, HierarchyKind::kKdTree}) {
    const Hierarchy hierarchy = city.build(kind);
    const LargeVector<std::byte> bytes = hierarchyBytes(hierarchy);
    const Result<Hierarchy> read = hierarchyFrom(bytes, city.objects);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->kind, kind);
    EXPECT_EQ(read->depth, hierarchy.depth);
    EXPECT_EQ(read->objects, hierarchy.objects);
    ASSERT_EQ(read->nodes.size(), hierarchy.nodes.size());
    for (std::size_t n = 0; n < hierarchy.nodes.size(); ++n) {
      EXPECT_EQ(read->nodes[n].bounds, hierarchy.nodes[n].bounds);
      EXPECT_EQ(read->nodes[n].link, hierarchy.nodes[n].link);
      EXPECT_EQ(read->nodes[n].leaf(), hierarchy.nodes[n].leaf());
    }
    EXPECT_FALSE(hierarchyFrom(bytes, city.objects + 1)) << "of another number of objects";
    EXPECT_FALSE(hierarchyFrom(bytes, city.objects - 1));
  }
  EXPECT_TRUE(hierarchyFrom(hierarchyBytes(buildHierarchy({}, {})), 0)) << "no objects";
}

TEST(HierarchyBytes, CutOffAnywhereTheyAreRefused) {
  const CityHierarchy city;
  const LargeVector<std::byte> bytes = hierarchyBytes(city.build(HierarchyKind::kBvh));
  test::expectCutOffIsRefused(bytes, "find them again", [&](std::span<const std::byte> cut) {
    return hierarchyFrom(cut, city.objects);
  });
}

TEST(HierarchyBytes, OfWhatIsNoTreeTheyAreRefused) {
  const CityHierarchy city;
  const auto refuses = [&](auto&& change) {
    Hierarchy hierarchy = city.build(HierarchyKind::kBvh);
    change(hierarchy);
    return !hierarchyFrom(hierarchyBytes(hierarchy), city.objects);
  };
  EXPECT_FALSE(refuses([](Hierarchy&) {}));
  EXPECT_TRUE(refuses([](Hierarchy& h) { ++h.nodes[0].link; }));
  EXPECT_TRUE(refuses([](Hierarchy& h) { h.nodes[0].link = 0; }));
  EXPECT_TRUE(refuses([](Hierarchy& h) { h.nodes[0].is_leaf = 1; }));
  EXPECT_TRUE(refuses([](Hierarchy& h) { h.nodes.back().is_leaf = 0; }));
  EXPECT_TRUE(refuses([](Hierarchy& h) { h.nodes.pop_back(); }));
  EXPECT_TRUE(refuses([](Hierarchy& h) { h.nodes.push_back(h.nodes.back()); }));
  EXPECT_TRUE(
      refuses([](Hierarchy& h) { h.nodes.back().link = static_cast<std::uint32_t>(h.objects.size()); }));
  EXPECT_TRUE(refuses([](Hierarchy& h) { h.nodes.back().link = 0; }));
  EXPECT_TRUE(refuses([](Hierarchy& h) { --h.depth; }));
  EXPECT_TRUE(refuses([](Hierarchy& h) { ++h.depth; }));
  EXPECT_TRUE(refuses([](Hierarchy& h) { h.objects[3] = h.objects[4]; })) << "an object is missing";
  EXPECT_TRUE(refuses([](Hierarchy& h) { h.objects[3] = ObjectId(); }));
  EXPECT_TRUE(refuses([](Hierarchy& h) { h.nodes[1].bounds.min.x = std::nanf(""); }));
}

TEST(HierarchyBytes, WithAnyBytesChangedEveryNodeHasItsObjectsOrTheyAreRefused) {
  const CityHierarchy city;
  const LargeVector<std::byte> bytes = hierarchyBytes(city.build(HierarchyKind::kBvh));
  std::mt19937 random(1);
  std::size_t read = 0;
  for (int i = 0; i < 2000; ++i) {
    LargeVector<std::byte> changed = bytes;
    changed[random() % changed.size()] = static_cast<std::byte>(random());
    const Result<Hierarchy> hierarchy = hierarchyFrom(changed, city.objects);
    if (!hierarchy) {
      continue;
    }
    ++read;
    std::set<std::uint32_t> below;
    for (std::uint32_t n = 0; n < hierarchy->nodes.size(); ++n) {
      ASSERT_FALSE(hierarchy->objectsBelow(NodeIndex(n)).empty());
    }
    for (const ObjectId object : hierarchy->objectsBelow(NodeIndex(0u))) {
      below.insert(object.value);
    }
    EXPECT_EQ(below.size(), city.objects);
  }
  EXPECT_GT(read, 100u) << "most bytes are coordinates";
  EXPECT_LT(read, 1900u);
}

}  // namespace
}  // namespace sightline
