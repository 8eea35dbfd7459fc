#include "src/layers/pairs/pair_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "tests/support/layer_shapes.h"

namespace sightline::layers {
namespace {

using Question = PairTable::Question;

bool isFresh(const PairWitness& witness) {
  return !witness.disjoint && witness.pairs == 0 && witness.direction == Vec3d() && witness.first[0] == 0;
}

TEST(PairTable, RemembersWhatWasWrittenForAPair) {
  PairTable table;
  table.beginFrame(1);
  EXPECT_EQ(table.size(), 0u);
  EXPECT_TRUE(isFresh(table.use(3, 5, Question::kOcclusion).witness));
  table.use(3, 5, Question::kOcclusion).witness.first[0] = 17;
  EXPECT_EQ(table.use(3, 5, Question::kOcclusion).witness.first[0], 17u);
  EXPECT_EQ(table.size(), 1u);
}

TEST(PairTable, IntersectionIsTheSameBothWaysAndOcclusionIsNot) {
  PairTable table;
  table.beginFrame(1);
  table.use(3, 5, Question::kIntersection).witness.first[0] = 1;
  EXPECT_EQ(table.use(5, 3, Question::kIntersection).witness.first[0], 1u);
  table.use(3, 5, Question::kOcclusion).witness.first[0] = 2;
  EXPECT_TRUE(isFresh(table.use(5, 3, Question::kOcclusion).witness));
  EXPECT_EQ(table.use(3, 5, Question::kIntersection).witness.first[0], 1u);
  EXPECT_EQ(table.size(), 3u);
}

TEST(PairTable, EntriesLastForAsManyFramesAsAskedFor) {
  for (std::uint32_t expiry = 0; expiry < 4; ++expiry) {
    PairTable table;
    table.beginFrame(expiry);
    table.use(1, 2, Question::kIntersection).witness.first[0] = 9;
    for (std::uint32_t frames_later = 1; frames_later <= expiry; ++frames_later) {
      table.beginFrame(expiry);
      EXPECT_EQ(table.size(), 1u) << frames_later << " of " << expiry;
    }
    table.beginFrame(expiry);
    EXPECT_EQ(table.size(), 0u) << expiry;
    EXPECT_TRUE(isFresh(table.use(1, 2, Question::kIntersection).witness)) << expiry;
  }
}

TEST(PairTable, NothingExpiresWhenNeverIsAskedFor) {
  PairTable table;
  table.use(1, 2, Question::kIntersection).witness.first[0] = 9;
  for (int frame = 0; frame < 50; ++frame) {
    table.beginFrame(0xffffffffu);
  }
  EXPECT_EQ(table.use(1, 2, Question::kIntersection).witness.first[0], 9u);
}

// The expected content of the table, kept in a plain map.
struct Model {
  using Key = std::tuple<std::uint32_t, std::uint32_t, Question>;
  struct Entry {
    std::uint32_t tag = 0;
    int last_frame = 0;
    bool used_before = false;  // whether use() had returned it in that frame
  };
  std::map<Key, Entry> entries;
  int frame = 0;

  void beginFrame(int expiry) {
    ++frame;
    std::erase_if(entries, [&](const auto& entry) { return entry.second.last_frame < frame - expiry; });
  }
  Entry& use(std::uint32_t a, std::uint32_t b, Question question) {
    if (question == Question::kIntersection) {
      std::tie(a, b) = std::minmax({a, b});
    }
    Entry& entry = entries[{a, b, question}];
    entry.used_before = entry.last_frame == frame;
    entry.last_frame = frame;
    return entry;
  }
};

TEST(PairTable, BehavesAsAMapUnderRandomUse) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    shapes::Random random(seed);
    PairTable table;
    Model model;
    std::uint32_t tag = 0;
    const std::uint32_t parts = 5u + (seed % 4u) * 30u;
    for (int frame = 0; frame < 40; ++frame) {
      const std::uint32_t expiry = random.below(3u);
      table.beginFrame(expiry);
      model.beginFrame(static_cast<int>(expiry));
      ASSERT_EQ(table.size(), model.entries.size());
      for (std::uint32_t uses = random.below(400u); uses > 0; --uses) {
        const std::uint32_t a = random.below(parts), b = random.below(parts);
        const Question question = random.below(2u) == 0 ? Question::kIntersection : Question::kOcclusion;
        const auto [witness, again] = table.use(a, b, question);
        Model::Entry& entry = model.use(a, b, question);
        ASSERT_EQ(again, entry.tag != 0 && entry.used_before) << a << ' ' << b;
        ASSERT_EQ(witness.first[0], entry.tag) << a << ' ' << b;
        witness.first[0] = entry.tag = ++tag;
      }
      ASSERT_EQ(table.size(), model.entries.size());
    }
  }
}

}  // namespace
}  // namespace sightline::layers
