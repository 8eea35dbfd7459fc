#include "sightline/base/large_vector.h"

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <mutex>
#include <new>

#include "src/base/memory_reuse.h"

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace sightline {
namespace {

constexpr std::size_t kPage = std::size_t{2} << 20;
constexpr std::size_t kLarge = 4 * kPage;  // below this, the last page would waste too much

#ifdef __linux__

std::size_t wholePages(std::size_t bytes) {
  return (bytes + kPage - 1) / kPage * kPage;
}

// bytes: whole pages.
std::byte* fromSystem(std::size_t bytes) {
  void* const mapped =
      mmap(nullptr, bytes + kPage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (mapped == MAP_FAILED) {
    throw std::bad_alloc();
  }
  // What lies before the first boundary between pages and behind the last one goes back.
  auto* const begin = static_cast<std::byte*>(mapped);
  const std::size_t before = (kPage - reinterpret_cast<std::uintptr_t>(begin) % kPage) % kPage;
  if (before > 0) {
    munmap(begin, before);
  }
  munmap(begin + before + bytes, kPage - before);
  madvise(begin + before, bytes, MADV_HUGEPAGE);  // a wish; what it returns changes nothing
  return begin + before;
}

// Free memory in whole pages, kept while somebody wants it to be.
class KeptMemory {
 public:
  void begin() {
    const std::lock_guard lock(mutex_);
    ++users_;
  }
  void end() {
    const std::lock_guard lock(mutex_);
    if (--users_ == 0) {
      for (const auto& [begin, size] : free_) {
        munmap(begin, size);
      }
      free_.clear();
    }
  }
  // The beginning of the smallest free range that is large enough; null if there is none.
  std::byte* take(std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    auto best = free_.end();
    for (auto range = free_.begin(); range != free_.end(); ++range) {
      if (range->second >= bytes && (best == free_.end() || range->second < best->second)) {
        best = range;
      }
    }
    if (best == free_.end()) {
      return nullptr;
    }
    const auto [begin, size] = *best;
    free_.erase(best);
    if (size > bytes) {
      free_.emplace(begin + bytes, size - bytes);
    }
    return begin;
  }
  void give(std::byte* begin, std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    if (users_ == 0) {
      munmap(begin, bytes);
      return;
    }
    const auto next = free_.lower_bound(begin);
    if (next != free_.end() && begin + bytes == next->first) {
      bytes += next->second;
      free_.erase(next);
    }
    const auto after = free_.lower_bound(begin);
    if (after != free_.begin()) {
      const auto before = std::prev(after);
      if (before->first + before->second == begin) {
        before->second += bytes;
        return;
      }
    }
    free_.emplace(begin, bytes);
  }

 private:
  std::mutex mutex_;
  std::size_t users_ = 0;
  std::map<std::byte*, std::size_t> free_;  // ranges, no two of which touch: begin and size
};

// It is never destroyed, because vectors that are may be destroyed later.
KeptMemory& keptMemory() {
  static KeptMemory& memory = *new KeptMemory;
  return memory;
}

#endif

}  // namespace

#ifdef __linux__

void* allocateLarge(std::size_t bytes) {
  if (bytes < kLarge) {
    return ::operator new(bytes);
  }
  if (bytes > static_cast<std::size_t>(PTRDIFF_MAX) - 2 * kPage) {
    throw std::bad_alloc();
  }
  const std::size_t size = wholePages(bytes);
  std::byte* const kept = keptMemory().take(size);
  return kept != nullptr ? kept : fromSystem(size);
}

void freeLarge(void* memory, std::size_t bytes) {
  if (bytes < kLarge) {
    ::operator delete(memory);
  } else {
    keptMemory().give(static_cast<std::byte*>(memory), wholePages(bytes));
  }
}

base::MemoryReuse::MemoryReuse() {
  keptMemory().begin();
}
base::MemoryReuse::~MemoryReuse() {
  keptMemory().end();
}

#else

void* allocateLarge(std::size_t bytes) {
  return ::operator new(bytes);
}

void freeLarge(void* memory, std::size_t) {
  ::operator delete(memory);
}

base::MemoryReuse::MemoryReuse() = default;
base::MemoryReuse::~MemoryReuse() = default;

#endif

}  // namespace sightline
