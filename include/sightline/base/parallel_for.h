#pragma once

// Threads belong to the caller. A function of the library that can use several takes a ParallelFor.
//
// Contract: run(count, body) calls body(begin, end) on disjoint ranges, some maybe empty, that cover
// [0, count), in any order, on any threads, and returns when all have. No result depends on how it was cut.

#include <cstdint>
#include <functional>

namespace sightline {

using RangeBody = std::function<void(std::uint32_t begin, std::uint32_t end)>;
using ParallelFor = std::function<void(std::uint32_t count, const RangeBody& body)>;

// The default: everything on the calling thread.
inline void serialFor(std::uint32_t count, const RangeBody& body) {
  if (count > 0) {
    body(0, count);
  }
}

}  // namespace sightline
