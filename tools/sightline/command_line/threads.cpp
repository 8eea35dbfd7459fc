#include "tools/sightline/command_line/threads.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace sightline::tool {

struct Threads::Pool {
  explicit Pool(std::uint32_t count)
      : limit(tbb::global_control::max_allowed_parallelism, count), arena(static_cast<int>(count)) {}

  tbb::global_control limit;
  tbb::task_arena arena;
};

Threads::Threads(std::uint32_t count) : pool_(count > 1 ? std::make_unique<Pool>(count) : nullptr) {
  // Starts the threads now: Embree's devices for one thread let oneTBB start none afterwards.
  parallelFor()(count, [](std::uint32_t, std::uint32_t) {});
}
Threads::~Threads() = default;

ParallelFor Threads::parallelFor() const {
  if (!pool_) {
    return serialFor;
  }
  return [pool = pool_.get()](std::uint32_t count, const RangeBody& body) {
    pool->arena.execute([&] {
      tbb::parallel_for(
          tbb::blocked_range<std::uint32_t>(0, count),
          [&](const tbb::blocked_range<std::uint32_t>& range) { body(range.begin(), range.end()); });
    });
  };
}

}  // namespace sightline::tool
