#include "src/pvs/format/set_code.h"

#include <gtest/gtest.h>

#include "tests/support/made_visibility.h"

namespace sightline::pvs {
namespace {

using Bytes = std::vector<std::byte>;
using Nodes = std::vector<std::uint32_t>;

Bytes bytes(std::initializer_list<int> values) {
  Bytes result;
  for (const int value : values) {
    result.push_back(static_cast<std::byte>(value));
  }
  return result;
}

// A root with this many leaves.
std::vector<BoxNode> flatTree(std::uint32_t leaves) {
  std::vector<BoxNode> tree(leaves + 1);
  for (std::uint32_t i = 0; i <= leaves; ++i) {
    tree[i].end = i == 0 ? leaves + 1 : i + 1;
  }
  return tree;
}

bool decodes(const Bytes& code, std::span<const BoxNode> tree) {
  Nodes nodes{7};
  const bool sound = decodeSet(code, endsOf(tree), nodes);
  EXPECT_EQ(nodes[0], 7u) << "what was there before is gone";
  EXPECT_TRUE(sound || nodes.size() == 1) << "a broken set left something";
  return sound;
}

TEST(SetCode, IsWhatTheSchemaSays) {
  Bytes code;
  appendSet(code, Nodes{1, 2, 131, 1000}, flatTree(1000));
  // Four nodes; 1; then the distances from the end of one to the next: 0, 128, 868 = 6 * 128 + 100.
  EXPECT_EQ(code, bytes({4, 1, 0, 0x80, 1, 0xe4, 6}));
}

TEST(SetCode, GivesBackEverySet) {
  for (std::uint32_t seed = 0; seed < 50; ++seed) {
    const made::Visibility settings{
        .seed = seed, .objects = 1 + seed * 40, .sets = 20, .set_nodes = seed * 3};
    const BakedVisibility baked = made::visibility(settings);
    const std::vector<std::uint32_t> ends = endsOf(baked.boxes.nodes);
    for (std::uint32_t set = 0; set < baked.sets.count(); ++set) {
      const auto expected = baked.sets[set];
      Bytes code;
      appendSet(code, expected, baked.boxes.nodes);
      EXPECT_LE(code.size(), maxSetBytes(expected.size()));
      Nodes nodes;
      ASSERT_TRUE(decodeSet(code, ends, nodes)) << "seed " << seed;
      EXPECT_EQ(nodes, Nodes(expected.begin(), expected.end())) << "seed " << seed;
    }
  }
}

TEST(SetCode, TakesTheLastNodeButNoneBeyond) {
  const auto tree = flatTree(200);
  EXPECT_TRUE(decodes(bytes({1, 0xc8, 1}), tree));   // 200
  EXPECT_FALSE(decodes(bytes({1, 0xc9, 1}), tree));  // 201
  EXPECT_FALSE(decodes(bytes({2, 0xc8, 1, 0}), tree));
}

TEST(SetCode, RefusesWhatIsNotExactlyOneSet) {
  const auto tree = flatTree(200);
  EXPECT_TRUE(decodes(bytes({0}), tree));
  EXPECT_TRUE(decodes(bytes({2, 1, 0}), tree));
  for (const Bytes& broken : {bytes({}), bytes({2, 1}), bytes({2, 1, 0, 0}), bytes({0, 0}), bytes({1, 0x80}),
                              bytes({0x80}), bytes({0xff, 0xff, 0xff, 0xff, 0x0f}),  // four billion nodes
                              bytes({1, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x01}),  // more than 32 bits
                              bytes({1, 0x81, 0x80, 0x80, 0x80, 0x10}),              // 2^32 + 1
                              bytes({2, 1, 0xff, 0xff, 0xff, 0xff, 0x0f})}) {        // around 2^32 and back
    EXPECT_FALSE(decodes(broken, tree));
  }
}

TEST(SetCode, RefusesANodeBelowAnother) {
  const auto tree = flatTree(5);
  EXPECT_TRUE(decodes(bytes({1, 0}), tree));      // the root
  EXPECT_FALSE(decodes(bytes({2, 0, 2}), tree));  // and a leaf below it
}

TEST(SetCode, SurvivesAnyBytes) {
  made::Random random(5);
  const BakedVisibility baked = made::visibility({.objects = 100});
  const std::vector<std::uint32_t> ends = endsOf(baked.boxes.nodes);
  for (int i = 0; i < 20000; ++i) {
    Bytes code(random() % 12);
    for (std::byte& byte : code) {
      byte = static_cast<std::byte>(random() % 3 == 0 ? random() % 256 : random() % 8);
    }
    Nodes nodes;
    if (decodeSet(code, ends, nodes)) {
      EXPECT_TRUE(soundSet(nodes, baked.boxes.nodes));
      Bytes again;
      appendSet(again, nodes, baked.boxes.nodes);
      EXPECT_LE(again.size(), code.size());
    }
  }
}

}  // namespace
}  // namespace sightline::pvs
