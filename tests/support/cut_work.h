#pragma once

// Ways of cutting work into ranges, with which results that do not depend on the threads must be the same.

#include <cstdint>
#include <thread>
#include <vector>

#include "sightline/base/parallel_for.h"

namespace sightline {

// Ranges of so many, the last one first.
inline ParallelFor backwardsBy(std::uint32_t step) {
  return [step](std::uint32_t count, const RangeBody& body) {
    for (std::uint32_t end = count; end > 0;) {
      const std::uint32_t begin = end > step ? end - step : 0;
      body(begin, end);
      end = begin;
    }
  };
}

// Each thread takes one of equal ranges.
inline ParallelFor onThreads(std::uint32_t threads) {
  return [threads](std::uint32_t count, const RangeBody& body) {
    const auto bound = [&](std::uint64_t t) { return static_cast<std::uint32_t>(count * t / threads); };
    std::vector<std::thread> running;
    for (std::uint32_t t = 0; t < threads; ++t) {
      if (bound(t) < bound(t + 1)) {
        running.emplace_back([&body, begin = bound(t), end = bound(t + 1)] { body(begin, end); });
      }
    }
    for (std::thread& thread : running) {
      thread.join();
    }
  };
}

}  // namespace sightline
