#include "tools/sightline/bench/machine.h"

#include <ctime>

#ifdef __linux__
#include <sched.h>
#endif
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace sightline::tool {

#ifdef __linux__

struct CorePin::Affinity {
  cpu_set_t cores{};
};

CorePin::CorePin() : before_(std::make_unique<Affinity>()) {
  const int core = ::sched_getcpu();
  if (core < 0 || core >= CPU_SETSIZE ||
      ::sched_getaffinity(0, sizeof(before_->cores), &before_->cores) != 0) {
    return;
  }
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(core, &one);
  if (::sched_setaffinity(0, sizeof(one), &one) == 0) {
    core_ = core;
  }
}

CorePin::~CorePin() {
  if (core_) {
    ::sched_setaffinity(0, sizeof(before_->cores), &before_->cores);
  }
}

#else

struct CorePin::Affinity {};
CorePin::CorePin() = default;
CorePin::~CorePin() = default;

#endif

double threadTimeUs() {
  timespec time{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) * 1e6 + static_cast<double>(time.tv_nsec) * 1e-3;
}

std::optional<std::size_t> heapBytes() {
#if defined(__GLIBC__) && __GLIBC_PREREQ(2, 33)
  const struct mallinfo2 info = ::mallinfo2();
  return info.uordblks + info.hblkhd;
#else
  return std::nullopt;
#endif
}

}  // namespace sightline::tool
