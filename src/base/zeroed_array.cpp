#include "src/base/zeroed_array.h"

#include <cstdlib>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace sightline::base {
namespace {

#ifdef __linux__
constexpr std::size_t kLarge = std::size_t{1} << 20;  // from here on pages are asked for, not a part of some
#endif

void* allocate(std::size_t bytes) {
#ifdef __linux__
  if (bytes >= kLarge) {
    void* const memory = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) {
      return nullptr;
    }
    // What is written lies far apart. This is a wish; what it returns changes nothing.
    madvise(memory, bytes, MADV_NOHUGEPAGE);
    return memory;
  }
#endif
  return std::calloc(bytes, 1);
}

}  // namespace

void* allocateZeroed(std::size_t bytes) {
  void* const memory = allocate(bytes);
  if (memory == nullptr) {
    throw std::bad_alloc();
  }
  return memory;
}

void freeZeroed(void* memory, std::size_t bytes) {
#ifdef __linux__
  if (bytes >= kLarge) {
    munmap(memory, bytes);
    return;
  }
#endif
  std::free(memory);
}

}  // namespace sightline::base
