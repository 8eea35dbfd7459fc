#include "src/base/memory_reuse.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <thread>
#include <utility>
#include <vector>

#include "sightline/base/large_vector.h"
#include "src/base/scratch_array.h"

namespace sightline::base {
namespace {

constexpr std::size_t kPage = std::size_t{2} << 20;

// A large vector that knows what it holds. Only some bytes are written and compared, a few in each page.
class Marked {
 public:
  Marked(std::size_t bytes, std::uint8_t mark) : bytes_(unsetVector<std::uint8_t>(bytes)), mark_(mark) {
    forEachPlace([this](std::uint8_t& byte) { byte = mark_; });
  }
  bool isWhole() {
    bool whole = true;
    forEachPlace([&](const std::uint8_t& byte) { whole = whole && byte == mark_; });
    return whole;
  }

 private:
  template <typename Visit>
  void forEachPlace(const Visit& visit) {
    constexpr std::size_t kApart = 4096;
    for (std::size_t at = 0; at < bytes_.size(); at += kApart) {
      visit(bytes_[at]);
    }
    visit(bytes_.back());
  }
  LargeVector<std::uint8_t> bytes_;
  std::uint8_t mark_;
};

// Makes and frees vectors of many sizes in any order, and looks whether each has kept what it holds.
void makeAndFree(std::mt19937& random, std::size_t steps, std::vector<Marked>& kept) {
  for (std::size_t step = 0; step < steps; ++step) {
    if (kept.size() >= 6 || (!kept.empty() && random() % 2 == 0)) {
      const std::size_t at = random() % kept.size();
      ASSERT_TRUE(kept[at].isWhole());
      std::swap(kept[at], kept.back());
      kept.pop_back();
    } else {
      // Some of whole pages, some a byte more or less, and some too small for pages of their own.
      const std::size_t bytes = (2 + random() % 10) * kPage + random() % 3 - 1;
      kept.emplace_back(bytes, static_cast<std::uint8_t>(step));
    }
  }
}

TEST(MemoryReuse, LeavesToEachVectorWhatItHolds) {
  for (std::uint32_t seed = 0; seed < 4; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    std::vector<Marked> kept;
    {
      const MemoryReuse reuse;
      makeAndFree(random, 60, kept);
    }
    EXPECT_TRUE(std::all_of(kept.begin(), kept.end(), [](Marked& vector) { return vector.isWhole(); }));
    makeAndFree(random, 10, kept);  // also once nothing is reused
  }
}

TEST(MemoryReuse, MayBeWantedWithinItself) {
  std::mt19937 random(5);
  std::vector<Marked> kept;
  const MemoryReuse outer;
  {
    const MemoryReuse inner;
    makeAndFree(random, 20, kept);
  }
  makeAndFree(random, 20, kept);
  EXPECT_TRUE(std::all_of(kept.begin(), kept.end(), [](Marked& vector) { return vector.isWhole(); }));
}

TEST(MemoryReuse, VectorsMayBeFreedByAnotherThread) {
  std::mt19937 random(6);
  std::vector<Marked> kept;
  {
    const MemoryReuse reuse;
    makeAndFree(random, 20, kept);
    std::thread([&] { makeAndFree(random, 20, kept); }).join();
    makeAndFree(random, 20, kept);
  }
  std::thread([&] { kept.clear(); }).join();
}

}  // namespace
}  // namespace sightline::base
