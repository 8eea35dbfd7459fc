#include "src/pvs/bake/runs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "src/pvs/bake/object_mask.h"

namespace sightline::pvs {
namespace {

using Bits = std::vector<bool>;

Runs runsOf(const Bits& bits) {
  Runs runs;
  for (std::uint32_t i = 0; i < bits.size(); ++i) {
    if (bits[i] && !runs.empty() && runs.back().end == i) {
      runs.back().end = i + 1;
    } else if (bits[i]) {
      runs.push_back({i, i + 1});
    }
  }
  return runs;
}

// Bits with long and short runs.
Bits randomBits(std::uint32_t count, std::mt19937& random) {
  Bits bits(count);
  const auto change = static_cast<std::uint32_t>(1 + random() % 70);
  bool bit = random() % 2 != 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    bit = random() % change == 0 ? !bit : bit;
    bits[i] = bit;
  }
  return bits;
}

TEST(Runs, AreSets) {
  for (std::uint32_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const auto count = static_cast<std::uint32_t>(1 + random() % 200);
    const Bits a = randomBits(count, random), b = randomBits(count, random);
    Bits both(count), either(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      both[i] = a[i] && b[i];
      either[i] = a[i] || b[i];
    }
    Runs out;
    intersect(runsOf(a), runsOf(b), out);
    EXPECT_EQ(out, runsOf(both));
    unite(runsOf(a), runsOf(b), out);
    EXPECT_EQ(out, runsOf(either));
    ObjectMask mask;
    mask.resetWithout(runsOf(a), count);
    mask.add(runsOf(b));
    mask.complement(out);
    Bits left(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      left[i] = a[i] && !b[i];
      EXPECT_EQ(mask.contains(i), !left[i]);
    }
    EXPECT_EQ(out, runsOf(left));
    subtract(runsOf(a), runsOf(b), out);
    EXPECT_EQ(out, runsOf(left));
  }
}

TEST(Runs, BecomeTheHighestNodesThatTheyFill) {
  for (std::uint32_t seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    std::vector<Box> boxes(1 + random() % 60);
    for (Box& box : boxes) {
      const Vec3f p(static_cast<float>(random() % 100), static_cast<float>(random() % 100), 0.0f);
      box = {p, p + Vec3f(1, 1, 1)};
    }
    const BoxTree tree = buildBoxTree(boxes, {});
    const Bits bits = randomBits(static_cast<std::uint32_t>(boxes.size()), random);
    std::vector<std::uint32_t> nodes;
    appendNodes(tree.view(), runsOf(bits), nodes);
    EXPECT_TRUE(std::is_sorted(nodes.begin(), nodes.end()));
    Bits covered(boxes.size(), false);
    for (const std::uint32_t n : nodes) {
      for (std::uint32_t i = 0; i < tree.nodes[n].object_count; ++i) {
        EXPECT_FALSE(covered[tree.nodes[n].first_object + i]) << "twice";
        covered[tree.nodes[n].first_object + i] = true;
      }
    }
    EXPECT_EQ(covered, bits);
    // No single node could replace several of the set.
    for (std::uint32_t n = 0; n < tree.nodes.size(); ++n) {
      const auto inside =
          std::ranges::count_if(nodes, [&](std::uint32_t m) { return m > n && m < tree.nodes[n].end; });
      bool all = true;
      for (std::uint32_t i = 0; i < tree.nodes[n].object_count; ++i) {
        all &= bits[tree.nodes[n].first_object + i];
      }
      EXPECT_FALSE(all && inside > 0) << "node " << n;
    }
  }
}

TEST(Runs, CountTriangles) {
  const std::vector<Box> boxes{{{0, 0, 0}, {1, 1, 1}}, {{5, 0, 0}, {6, 1, 1}}, {{9, 0, 0}, {10, 1, 1}}};
  const std::vector<std::uint32_t> triangles{10, 200, 3000};
  const BoxTree tree = buildBoxTree(boxes, triangles);
  const TriangleCounts counts(tree.view());
  for (std::uint32_t i = 0; i < 3; ++i) {
    const ObjectRun one{i, i + 1};
    EXPECT_EQ(counts.of(std::span(&one, 1)), triangles[tree.objects[i].value]);
  }
  const ObjectRun all{0, 3};
  EXPECT_EQ(counts.of(std::span(&all, 1)), 3210u);
}

}  // namespace
}  // namespace sightline::pvs
