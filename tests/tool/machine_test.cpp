#include "tools/sightline/bench/machine.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

#ifdef __linux__
#include <sched.h>
#endif

namespace sightline::tool {
namespace {

// How many cores the calling thread may run on; 1 where the system does not tell.
int coresOfThisThread() {
#ifdef __linux__
  cpu_set_t cores;
  return ::sched_getaffinity(0, sizeof(cores), &cores) == 0 ? CPU_COUNT(&cores) : 1;
#else
  return 1;
#endif
}

TEST(CorePin, KeepsTheThreadOnOneCoreUntilItEnds) {
  const int before = coresOfThisThread();
  {
    const CorePin pin;
    // Skipped where it cannot be tested: some systems have no call for it, and some containers refuse it.
    if (!pin.core()) {
      GTEST_SKIP() << "threads cannot be pinned on this system";
    }
    EXPECT_EQ(coresOfThisThread(), 1);
  }
  EXPECT_EQ(coresOfThisThread(), before);
}

TEST(ThreadTime, CountsTheWorkOfThisThreadAlone) {
  const double start = threadTimeUs();
  std::thread([] {
    const double other = threadTimeUs();
    while (threadTimeUs() < other + 20'000.0) {
    }
  }).join();
  const double waited = threadTimeUs();
  EXPECT_LT(waited - start, 20'000.0) << "the work of another thread counts";
  while (threadTimeUs() < waited + 1'000.0) {
  }
  EXPECT_GE(threadTimeUs() - start, 1'000.0);
}

TEST(HeapGrowth, IsWhatWasAllocatedAndNotFreed) {
  // Skipped where there is nothing to test: sanitizers replace the allocator and leave its counts at zero.
  if (heapBytes().value_or(0) == 0) {
    GTEST_SKIP() << "the C library, or a sanitizer's, does not tell";
  }
  const HeapGrowth growth;
  std::vector<char> kept(1'000'000, 'a');
  EXPECT_GE(*growth.bytes(), kept.size());
  EXPECT_LT(*growth.bytes(), 2 * kept.size());
  kept = {};
  kept.shrink_to_fit();
  EXPECT_LT(*growth.bytes(), 100'000u);
}

}  // namespace
}  // namespace sightline::tool
