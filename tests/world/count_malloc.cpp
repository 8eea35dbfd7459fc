// Takes the place of the C library's malloc and of what belongs to it, to count what this program takes from
// it, which operator new does too. Left out with sanitizers, which have functions of their own in that place.

#include <atomic>
#include <cstddef>

#if defined(__GLIBC__)

namespace {
std::atomic<std::size_t> calls{0};
}

namespace sightline::test {
std::size_t callsOfMalloc() {
  return calls;
}
}  // namespace sightline::test

extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) noexcept {
  ++calls;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) noexcept {
  ++calls;
  return __libc_calloc(count, size);
}
void* realloc(void* memory, std::size_t size) noexcept {
  ++calls;
  return __libc_realloc(memory, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  ++calls;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) noexcept {
  ++calls;
  *memory = __libc_memalign(alignment, size);
  return *memory == nullptr ? 12 : 0;
}
}

#endif
