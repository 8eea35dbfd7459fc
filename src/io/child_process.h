#pragma once

// Runs code of others in a process of its own, so that a crash, an endless loop or all memory taken there is
// one error here.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "sightline/base/result.h"

namespace sightline::io {

struct ChildLimits {
  std::uint64_t memory_bytes = 0;  // beyond what this process has already
  std::uint32_t seconds = 0;       // of processor time; of real time, ten times as many
};

// Calls work() in a child of this process and returns the bytes that it returned there. Whatever else it does
// stays there: it has no output, and ends with this process. The error says that it crashed, took too long or
// needed too much memory, and is to be read after "NAME: ".
//
// May be called by several threads at once. The child is a fork with the calling thread alone, so work() must
// not wait for a lock that another thread may hold just then, nor for another thread; allocating is safe.
// Nothing is left of the child when this returns or throws std::bad_alloc.
Result<std::vector<std::byte>> runInChild(const ChildLimits& limits,
                                          const std::function<std::vector<std::byte>()>& work);

}  // namespace sightline::io
