#include "sightline/base/large_vector.h"

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace sightline {
namespace {

constexpr std::size_t kPage = std::size_t{2} << 20;
constexpr std::size_t kLarge = 4 * kPage;  // below this, the last page would waste too much

}  // namespace

void* allocateLarge(std::size_t bytes) {
  if (bytes < kLarge) {
    return ::operator new(bytes);
  }
  void* memory = ::operator new(bytes, std::align_val_t(kPage));
#ifdef __linux__
  madvise(memory, bytes, MADV_HUGEPAGE);  // a wish; what it returns changes nothing
#endif
  return memory;
}

void freeLarge(void* memory, std::size_t bytes) {
  if (bytes < kLarge) {
    ::operator delete(memory);
  } else {
    ::operator delete(memory, std::align_val_t(kPage));
  }
}

}  // namespace sightline
