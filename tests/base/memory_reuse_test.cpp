#include "src/base/memory_reuse.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <random>
#include <thread>
#include <vector>

#include "sightline/base/large_vector.h"

namespace sightline::base {
namespace {

constexpr std::size_t kMiB = std::size_t{1} << 20;

// Large memory that is filled with a number of its own, to find out whether somebody else got it as well.
struct Filled {
  LargeVector<unsigned char> bytes;
  unsigned char number;

  Filled(std::size_t size, unsigned char with) : bytes(size, with), number(with) {}
  bool isWhole() const {
    return std::all_of(bytes.begin(), bytes.end(), [this](unsigned char byte) { return byte == number; });
  }
};

// Allocates and frees at random, and looks at what is there.
bool survives(std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<Filled> live;
  bool whole = true;
  for (int step = 0; step < 60; ++step) {
    if (live.size() < 4 && random() % 3 != 0) {
      live.emplace_back((8 + random() % 24) * kMiB - random() % 5000, static_cast<unsigned char>(random()));
    } else if (!live.empty()) {
      const std::size_t at = random() % live.size();
      whole = whole && live[at].isWhole();
      std::swap(live[at], live.back());
      live.pop_back();
    }
  }
  return whole &&
         std::all_of(live.begin(), live.end(), [](const Filled& filled) { return filled.isWhole(); });
}

TEST(MemoryReuse, NeverHandsOutWhatIsInUse) {
  for (const std::uint32_t seed : {1u, 2u}) {
    const MemoryReuse reuse;
    bool other_survives = false;
    std::thread other([&] { other_survives = survives(seed + 100); });
    EXPECT_TRUE(survives(seed)) << "seed " << seed;
    other.join();
    EXPECT_TRUE(other_survives) << "seed " << seed + 100;
  }
}

TEST(MemoryReuse, WhatIsThereOutlivesIt) {
  LargeVector<unsigned char> bytes;
  {
    const MemoryReuse reuse;
    LargeVector<unsigned char>(40 * kMiB, 1);
    bytes.assign(9 * kMiB, 2);  // a part of what was free
  }
  EXPECT_EQ(std::count(bytes.begin(), bytes.end(), 2), static_cast<std::ptrdiff_t>(9 * kMiB));
  bytes.assign(30 * kMiB, 3);
  EXPECT_EQ(std::count(bytes.begin(), bytes.end(), 3), static_cast<std::ptrdiff_t>(30 * kMiB));
}

#ifdef __linux__

TEST(MemoryReuse, WhatIsFreedServesTheNext) {
  const MemoryReuse outer;
  const std::byte* first = nullptr;
  {
    const MemoryReuse inner;
    const LargeVector<std::byte> bytes(16 * kMiB);
    first = bytes.data();
  }
  const LargeVector<std::byte> next(15 * kMiB);
  EXPECT_EQ(next.data(), first);
}

TEST(MemoryReuse, RangesAreDividedAndJoinedAgain) {
  const MemoryReuse reuse;
  LargeVector<std::byte> whole(48 * kMiB);
  const std::byte* const begin = whole.data();
  whole = LargeVector<std::byte>();
  for (const auto& order : {std::vector{0, 1, 2}, {2, 1, 0}, {0, 2, 1}, {1, 0, 2}}) {
    std::vector<LargeVector<std::byte>> parts;
    for (int i = 0; i < 3; ++i) {
      parts.emplace_back(16 * kMiB);
      EXPECT_GE(parts.back().data(), begin);
      EXPECT_LE(parts.back().data() + parts.back().size(), begin + 48 * kMiB);
    }
    for (const int part : order) {
      parts[static_cast<std::size_t>(part)] = LargeVector<std::byte>();
    }
    EXPECT_EQ(LargeVector<std::byte>(48 * kMiB).data(), begin);
  }
}

#endif

}  // namespace
}  // namespace sightline::base
