// What a bake keeps beside its result: packed bytes, runs, and answers, sound and forged.

#include "src/pvs/bake/file/packed_bytes.h"

#include <gtest/gtest.h>
#include <zstd.h>

#include <random>

#include "src/base/byte_stream.h"
#include "src/pvs/bake/file/run_code.h"
#include "src/pvs/bake/update/answers.h"

namespace sightline::pvs {
namespace {

using Bytes = std::vector<std::byte>;

// The length that is claimed, then what is stored.
Bytes claimed(std::uint64_t length, std::span<const std::byte> stored) {
  base::ByteWriter bytes;
  bytes.add(length);
  bytes.addBytes(stored);
  return bytes.take();
}

Bytes zstdFrame(const Bytes& raw) {
  Bytes frame(ZSTD_compressBound(raw.size()));
  frame.resize(ZSTD_compress(frame.data(), frame.size(), raw.data(), raw.size(), 3));
  return frame;
}

TEST(PackedBytes, ComeBackWhateverTheyAre) {
  std::mt19937 random(5);
  for (const std::size_t size : {0u, 1u, 7u, 300u, 100'000u, 3'000'000u}) {
    for (const unsigned values : {1u, 3u, 256u}) {
      Bytes bytes(size);
      for (std::byte& byte : bytes) {
        byte = static_cast<std::byte>(random() % values);
      }
      const Bytes packed = pack(bytes);
      EXPECT_LE(packed.size(), bytes.size() + sizeof(std::uint64_t));
      const std::optional<Bytes> back = unpack(packed);
      ASSERT_TRUE(back) << size << " bytes of " << values << " values";
      EXPECT_TRUE(*back == bytes);
    }
  }
}

TEST(PackedBytes, OfFewValuesAreShorter) {
  Bytes bytes(100'000);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = static_cast<std::byte>(i * i / 777 % 5);
  }
  EXPECT_LT(pack(bytes).size(), bytes.size() / 2);
}

TEST(PackedBytes, AreRefusedWhenTheyClaimMoreThanSoFewCanHold) {
  const Bytes zeros(50'000'000);
  const Bytes frame = zstdFrame(zeros);
  ASSERT_LT(frame.size(), 9000u) << "the frame is sound and short";
  EXPECT_FALSE(unpack(claimed(zeros.size(), frame)));
  EXPECT_FALSE(unpack(claimed(std::uint64_t{1} << 62, frame)));
  EXPECT_FALSE(unpack(claimed(frame.size() * kMaxPackedGain, frame))) << "and it holds more than it says";
  EXPECT_FALSE(unpack(claimed(1'000, Bytes(10, std::byte{3})))) << "no frame";
  EXPECT_FALSE(unpack(claimed(3, Bytes(10)))) << "more is stored than it says";
  EXPECT_FALSE(unpack(Bytes(7))) << "no length";
  EXPECT_FALSE(unpack({}));
  Bytes cut = pack(Bytes(2000, std::byte{1}));
  cut.pop_back();
  EXPECT_FALSE(unpack(cut));
}

TEST(RunCode, GivesBackRunsAndRefusesWhatIsNone) {
  const auto bytesOf = [](const std::vector<std::uint64_t>& numbers) {
    base::ByteWriter bytes;
    for (const std::uint64_t number : numbers) {
      addCount(number, bytes);
    }
    return bytes.take();
  };
  const auto isRead = [](const Bytes& bytes, Runs& runs) {
    base::ByteReader reader(bytes);
    return readRuns(reader, 1000, runs) && reader.atEnd();
  };
  Runs runs;
  const Runs some{{0, 3}, {4, 500}, {998, 1000}};
  base::ByteWriter written;
  addRuns(some, written);
  ASSERT_TRUE(isRead(written.take(), runs));
  EXPECT_EQ(runs, some);
  ASSERT_TRUE(isRead(bytesOf({0}), runs));
  EXPECT_TRUE(runs.empty());
  // The number of runs, then gap and length of each.
  EXPECT_TRUE(isRead(bytesOf({2, 0, 5, 1, 994}), runs));
  EXPECT_FALSE(isRead(bytesOf({2, 0, 5, 0, 5}), runs)) << "two that touch";
  EXPECT_FALSE(isRead(bytesOf({1, 3, 0}), runs)) << "an empty one";
  EXPECT_FALSE(isRead(bytesOf({2, 0, 5, 1, 995}), runs)) << "beyond the objects";
  EXPECT_FALSE(isRead(bytesOf({1, ~std::uint64_t{0}, 5}), runs));
  EXPECT_FALSE(isRead(bytesOf({900, 0, 1}), runs)) << "fewer than it says";
  EXPECT_FALSE(isRead({}, runs));
}

CellAnswers someAnswers() {
  CellAnswers answers;
  answers[9] = {
      {.kind = AnswerKind::kConvex, .question = 1, .asked = {{0, 7}, {9, 30}}, .seen = {{1, 2}, {9, 12}}},
      {.kind = AnswerKind::kFused,
       .question = 2,
       .seen = {{0, 1}},
       .hidden_nodes = {2, 40},
       .followed = {{0, 0, 0, 9, 9, 9}, kWholeFrame}},
      {.kind = AnswerKind::kPoint, .question = 3, .least = 4, .most = 5}};
  answers[77] = {answers[9][2]};
  return answers;
}

TEST(Answers, AreGivenBack) {
  const Bytes bytes = encodeAnswers(someAnswers());
  const std::optional<CellAnswers> back = decodeAnswers(bytes, 30, 50);
  ASSERT_TRUE(back);
  EXPECT_EQ(encodeAnswers(*back), bytes);
  ASSERT_EQ(back->at(9).size(), 3u);
  EXPECT_EQ(back->at(9)[0].asked, someAnswers()[9][0].asked);
  EXPECT_EQ(back->at(9)[1].followed, someAnswers()[9][1].followed);
  EXPECT_EQ(back->at(77)[0].most, 5u);
  EXPECT_FALSE(decodeAnswers(bytes, 29, 50)) << "an object that is not there";
  EXPECT_FALSE(decodeAnswers(bytes, 30, 40)) << "a node that is not there";
}

TEST(Answers, CutOffAnywhereAreRefusedOrFewer) {
  const std::optional<Bytes> plain = unpack(encodeAnswers(someAnswers()));
  ASSERT_TRUE(plain);
  for (std::size_t length = 0; length < plain->size(); ++length) {
    const std::optional<CellAnswers> back = decodeAnswers(pack(std::span(*plain).first(length)), 30, 50);
    EXPECT_TRUE(!back || back->size() < 2) << length;
  }
}

// Zeros are a cell without answers, again and again.
TEST(Answers, OfAForgedLengthAreRefusedBeforeTheyTakeMemory) {
  const Bytes zeros(100'000'000);
  EXPECT_FALSE(decodeAnswers(claimed(zeros.size(), zstdFrame(zeros)), 30, 50));
  // A count of boxes that so many bytes cannot hold, for which memory was reserved.
  base::ByteWriter forged;
  forged.add(std::uint64_t{9});
  addCount(1, forged);
  forged.add(static_cast<std::uint8_t>(AnswerKind::kFused));
  forged.add(std::uint64_t{2});
  for (const std::uint64_t count : {0u, 0u, 0xfffffff0u}) {  // seen, hidden_nodes, followed
    addCount(count, forged);
  }
  EXPECT_FALSE(decodeAnswers(pack(forged.take()), 30, 0xffffffffu));
}

}  // namespace
}  // namespace sightline::pvs
