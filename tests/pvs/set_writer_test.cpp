// Sets are packed into chunks as they come, and found again there.

#include "src/pvs/bake/file/set_writer.h"

#include "tests/pvs/sight_checks.h"

namespace sightline::sight_test {
namespace {

using pvs::EncodedChunks;

// Sets of about so many nodes.
BakedVisibility visibilityOf(std::uint32_t set_nodes) {
  return made::visibility({.objects = 3 * set_nodes + 40, .leaves = 40, .sets = 60, .set_nodes = set_nodes});
}

TEST(SetWriter, PacksSetsThatDecodeToTheSameOfAnyLength) {
  for (const std::uint32_t set_nodes : {1u, 30u, 700u, 5000u, 30000u}) {
    SCOPED_TRACE(set_nodes);
    const BakedVisibility baked = visibilityOf(set_nodes);
    const Bytes bytes = bytesOf(baked);
    const Result<SightFile> file = opened(bytes);
    ASSERT_TRUE(file) << errorOf(file);
    std::uint32_t count = 0;
    const Status whole = file->forEachSet([&](std::uint32_t set, std::span<const std::uint32_t> nodes) {
      EXPECT_TRUE(sameBytes(nodes, baked.sets[set]));
      count += 1;
    });
    EXPECT_EQ(errorOf(whole), "");
    EXPECT_EQ(count, baked.sets.count());
  }
}

TEST(SetWriter, SharesAChunkAmongManyShortSetsAndFewLongOnes) {
  for (const std::uint32_t set_nodes : {30u, 700u, 5000u, 30000u}) {
    SCOPED_TRACE(set_nodes);
    const EncodedChunks encoded = pvs::encodeChunks(visibilityOf(set_nodes));
    std::vector<std::uint32_t> sets_in(encoded.set_chunks);
    for (const pvs::SetPlace& place : encoded.sets) {
      sets_in[place.chunk] += 1;
    }
    for (std::uint32_t chunk = 0; chunk < encoded.set_chunks; ++chunk) {
      EXPECT_TRUE(sets_in[chunk] == 1 || encoded.chunks[chunk].raw_bytes <= pvs::kMaxSetChunkBytes);
      EXPECT_TRUE(sets_in[chunk] <= 16 || encoded.chunks[chunk].raw_bytes <= pvs::kSetChunkBytes);
    }
    EXPECT_LT(encoded.set_chunks, encoded.sets.size()) << "no chunk holds two sets";
  }
}

// Keeps the payload, and counts what is read of it.
class Kept final : public pvs::Payload {
 public:
  bool append(std::span<const std::byte> more) override {
    bytes.insert(bytes.end(), more.begin(), more.end());
    return true;
  }
  bool read(std::uint64_t offset, std::span<std::byte> out) override {
    reads += 1;
    std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(offset), out.size(), out.begin());
    return !broken;
  }
  Bytes bytes;
  int reads = 0;
  bool broken = false;
};

TEST(SetWriter, FindsEachSetAgainBeforeAndAfterItsChunkIsWritten) {
  for (const std::uint32_t set_nodes : {200u, 700u}) {
    const BakedVisibility baked = visibilityOf(set_nodes);
    Kept payload;
    EncodedChunks encoded;
    pvs::SetWriter writer(baked.boxes.nodes, payload, encoded);
    for (std::uint32_t set = 0; set < baked.sets.count(); ++set) {
      writer.add(baked.sets[set]);
      for (std::uint32_t before = 0; before <= set; ++before) {
        EXPECT_TRUE(writer.same(before, baked.sets[before])) << before << " of " << set;
        EXPECT_EQ(writer.same(before, baked.sets[set]), sameBytes(baked.sets[before], baked.sets[set]));
      }
    }
    EXPECT_GT(payload.reads, 0);
    EXPECT_TRUE(writer.sound());
    // What cannot be read again is no set that is known.
    payload.broken = true;
    EXPECT_FALSE(writer.same(0, baked.sets[0]));
  }
}

TEST(SetWriter, NotesASetThatIsNotSound) {
  const BakedVisibility baked = visibilityOf(30);
  Kept payload;
  EncodedChunks encoded;
  pvs::SetWriter writer(baked.boxes.nodes, payload, encoded);
  const auto last = static_cast<std::uint32_t>(baked.boxes.nodes.size() - 1);
  writer.add(std::vector<std::uint32_t>{last});
  EXPECT_TRUE(writer.sound());
  writer.add(std::vector<std::uint32_t>{0, last});
  EXPECT_FALSE(writer.sound()) << "the last node is below the root";
}

}  // namespace
}  // namespace sightline::sight_test
