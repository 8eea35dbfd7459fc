#include "src/base/byte_stream.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>

namespace sightline::base {
namespace {

using Bytes = std::vector<std::byte>;

Bytes bytesOf(std::initializer_list<int> values) {
  Bytes bytes;
  for (const int value : values) {
    bytes.push_back(static_cast<std::byte>(value));
  }
  return bytes;
}

TEST(ByteWriter, PutsTheLeastSignificantByteFirst) {
  ByteWriter writer;
  writer.add(std::uint32_t{0x01020304u});
  writer.add(std::int16_t{-2});
  writer.add(1.0f);  // 0x3f800000
  writer.add(std::uint64_t{0x1122334455667788ull});
  EXPECT_EQ(writer.size(), 18u);
  EXPECT_EQ(writer.take(), bytesOf({4, 3, 2, 1, 0xfe, 0xff, 0, 0, 0x80, 0x3f, 0x88, 0x77, 0x66, 0x55, 0x44,
                                    0x33, 0x22, 0x11}));
  EXPECT_EQ(writer.size(), 0u);
}

template <typename T>
void expectToComeBack(std::initializer_list<T> values) {
  ByteWriter writer;
  writer.addAll(std::span<const T>(values));
  writer.add(std::uint8_t{77});
  const Bytes bytes = writer.take();
  ASSERT_EQ(bytes.size(), values.size() * sizeof(T) + 1);

  ByteReader one_by_one(bytes);
  for (const T value : values) {
    EXPECT_EQ(one_by_one.read<T>(), value);
  }
  EXPECT_EQ(one_by_one.read<std::uint8_t>(), 77);
  EXPECT_TRUE(one_by_one.atEnd());

  ByteReader at_once(bytes);
  EXPECT_EQ(at_once.readAll<T>(values.size()), std::vector<T>(values));
  EXPECT_EQ(at_once.position(), bytes.size() - 1);
  EXPECT_FALSE(at_once.atEnd());
}

TEST(ByteReader, GivesEveryNumberBack) {
  expectToComeBack<std::uint8_t>({0, 1, 255});
  expectToComeBack<std::int8_t>({-128, -1, 127});
  expectToComeBack<char>({'a', '\0', 'z'});
  expectToComeBack<std::uint16_t>({0, 258, 0xffff});
  expectToComeBack<std::uint32_t>({0, 0x01020304u, 0xffffffffu});
  expectToComeBack<std::int32_t>({std::numeric_limits<std::int32_t>::min(), -1, 0x7fffffff});
  expectToComeBack<std::uint64_t>({0, 0x0102030405060708ull, ~std::uint64_t{0}});
  expectToComeBack<std::int64_t>({std::numeric_limits<std::int64_t>::min(), -1});
  expectToComeBack<float>({0.1f, -3.4e38f, std::numeric_limits<float>::infinity()});
  expectToComeBack<double>({0.1, -1e308, std::numeric_limits<double>::denorm_min()});
}

TEST(ByteReader, KeepsTheSignOfZeroAndTheBitsOfNan) {
  ByteWriter writer;
  writer.add(-0.0);
  writer.add(std::bit_cast<double>(0x7ff8000000000123ull));
  const Bytes bytes = writer.take();
  ByteReader reader(bytes);
  EXPECT_TRUE(std::signbit(reader.read<double>()));
  EXPECT_EQ(std::bit_cast<std::uint64_t>(reader.read<double>()), 0x7ff8000000000123ull);
}

TEST(ByteReader, GivesZeroFromTheFirstReadPastTheEndOn) {
  const Bytes bytes = bytesOf({1, 2, 3, 4, 5, 6});
  ByteReader reader(bytes);
  EXPECT_EQ(reader.read<std::uint32_t>(), 0x04030201u);
  EXPECT_EQ(reader.read<std::uint32_t>(), 0u);  // two bytes are left
  EXPECT_FALSE(reader.ok());
  EXPECT_EQ(reader.position(), 4u);
  EXPECT_EQ(reader.read<std::uint8_t>(), 0);  // though there is one
  EXPECT_TRUE(reader.readAll<std::uint8_t>(1).empty());
  EXPECT_TRUE(reader.readBytes(1).empty());
  EXPECT_EQ(reader.readCount<std::uint8_t>(1), 0);
  EXPECT_FALSE(reader.ok());
  EXPECT_FALSE(reader.atEnd());
  EXPECT_EQ(reader.position(), 4u);
}

TEST(ByteReader, ReadsAllOrNothing) {
  const Bytes bytes(10);
  ByteReader fits(bytes), too_long(bytes);
  EXPECT_EQ(fits.readAll<std::uint16_t>(5).size(), 5u);
  EXPECT_TRUE(fits.atEnd());
  EXPECT_EQ(fits.readBytes(0).size(), 0u);
  EXPECT_TRUE(fits.ok());
  EXPECT_EQ(too_long.readAll<std::uint16_t>(6).capacity(), 0u);
  EXPECT_FALSE(too_long.ok());
}

// Times eight, these wrap to what would fit.
TEST(ByteReader, IsNotDeceivedByNumbersThatOverflow) {
  for (const std::uint64_t count :
       {~std::uint64_t{0}, std::uint64_t{1} << 61, (std::uint64_t{1} << 61) + 1}) {
    ByteWriter writer;
    writer.add(count);
    writer.add(std::uint64_t{0});
    const Bytes bytes = writer.take();
    ByteReader all(bytes), counted(bytes), raw(bytes);
    EXPECT_EQ(all.readAll<double>(count).capacity(), 0u);
    EXPECT_FALSE(all.ok());
    EXPECT_EQ(counted.readCount<std::uint64_t>(8), 0u);
    EXPECT_FALSE(counted.ok());
    EXPECT_EQ(counted.position(), 0u);
    EXPECT_TRUE(raw.readBytes(count).empty());
    EXPECT_FALSE(raw.ok());
  }
}

TEST(ByteReader, AcceptsACountThatTheRestCanHoldAndNoGreaterOne) {
  for (const std::uint32_t count : {0u, 1u, 2u, 3u}) {
    ByteWriter writer;
    writer.add(count);
    writer.addAll(std::span<const std::uint8_t>(std::array<std::uint8_t, 23>{}));  // two things of 8, and 7
    const Bytes bytes = writer.take();
    ByteReader reader(bytes);
    EXPECT_EQ(reader.readCount<std::uint32_t>(8), count <= 2 ? count : 0);
    EXPECT_EQ(reader.ok(), count <= 2);
    EXPECT_EQ(reader.position(), count <= 2 ? 4u : 0u);
  }
}

TEST(ByteReader, ExpectsWithoutReading) {
  const Bytes bytes(10);
  ByteReader reader(bytes);
  reader.read<std::uint16_t>();
  reader.expect(2, 4);
  EXPECT_TRUE(reader.ok());
  EXPECT_EQ(reader.position(), 2u);
  reader.expect(3, 4);
  EXPECT_FALSE(reader.ok());
  EXPECT_EQ(reader.position(), 2u);
  reader.expect(0, 1);
  EXPECT_FALSE(reader.ok());
}

TEST(ByteReader, SharesBytesWithWhatItReads) {
  ByteWriter writer;
  writer.add(std::uint8_t{9});
  writer.addBytes(bytesOf({1, 2, 3}));
  const Bytes bytes = writer.take();
  ByteReader reader(bytes);
  EXPECT_EQ(reader.read<std::uint8_t>(), 9);
  const std::span<const std::byte> rest = reader.readBytes(3);
  EXPECT_EQ(rest.data(), bytes.data() + 1);
  EXPECT_EQ(Bytes(rest.begin(), rest.end()), bytesOf({1, 2, 3}));
}

}  // namespace
}  // namespace sightline::base
