#pragma once

#include <cstdint>
#include <memory>

#include "sightline/base/parallel_for.h"

namespace sightline::tool {

// The tool's threads (oneTBB), never more than `count`.
class Threads {
 public:
  explicit Threads(std::uint32_t count);
  ~Threads();

  // Valid as long as this object.
  ParallelFor parallelFor() const;

 private:
  struct Pool;
  std::unique_ptr<Pool> pool_;  // null with one thread
};

}  // namespace sightline::tool
