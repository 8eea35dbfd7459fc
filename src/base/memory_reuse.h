#pragma once

namespace sightline::base {

// While one exists, large vectors that its thread frees leave their memory to those that the thread asks for
// next, and the last of several gives back what is left. Memory from the system is cleared as it is touched
// for the first time, which takes about as long as to fill it; what large steps leave to each other is not.
// For functions that make and free many large vectors one after the other.
class MemoryReuse {
 public:
  MemoryReuse();
  MemoryReuse(const MemoryReuse&) = delete;
  MemoryReuse& operator=(const MemoryReuse&) = delete;
  ~MemoryReuse();
};

}  // namespace sightline::base
