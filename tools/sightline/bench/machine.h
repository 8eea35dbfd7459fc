#pragma once

// What measuring asks of the machine: one core, the thread's own processor time, the memory in use.

#include <cstddef>
#include <memory>
#include <optional>

namespace sightline::tool {

// Keeps the calling thread on the core on which it runs now, until the destructor.
class CorePin {
 public:
  CorePin();
  ~CorePin();
  CorePin(const CorePin&) = delete;
  CorePin& operator=(const CorePin&) = delete;

  // The core's number; none where the system has no such call or refuses it.
  std::optional<int> core() const { return core_; }

 private:
  struct Affinity;
  std::unique_ptr<Affinity> before_;
  std::optional<int> core_;
};

// Processor time that the calling thread has used, microseconds.
double threadTimeUs();

// Bytes that the program has allocated and not freed; none where the C library cannot tell.
std::optional<std::size_t> heapBytes();

// The growth of heapBytes() since construction.
class HeapGrowth {
 public:
  // None where the C library cannot tell; 0 if the heap has shrunk.
  std::optional<std::size_t> bytes() const {
    const std::optional<std::size_t> now = heapBytes();
    return now && before_ ? std::optional(*now > *before_ ? *now - *before_ : 0) : std::nullopt;
  }

 private:
  std::optional<std::size_t> before_ = heapBytes();
};

}  // namespace sightline::tool
