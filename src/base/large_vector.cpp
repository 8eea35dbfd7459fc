// Where the system lets us, large vectors have pages of their own, which any range of addresses may get: so
// those of freed vectors, of any sizes, make up new ones.

#include "sightline/base/large_vector.h"

#include <algorithm>
#include <cstdint>

#include "src/base/memory_reuse.h"

// Sanitizers look for errors in memory that they allocate themselves.
#if defined(__linux__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define SIGHTLINE_OWN_PAGES 1
#include <sys/mman.h>
#else
#define SIGHTLINE_OWN_PAGES 0
#endif

namespace sightline {
namespace {

constexpr std::size_t kPage = std::size_t{2} << 20;
constexpr std::size_t kLarge = 4 * kPage;  // below this, the last page would waste too much

#if SIGHTLINE_OWN_PAGES

std::size_t wholePages(std::size_t bytes) {
  return (bytes + kPage - 1) / kPage * kPage;
}

// Memory for so many bytes, whole pages; throws if there is none.
std::byte* newPages(std::size_t bytes) {
  // With a page more, so that there is a place for it to begin at.
  void* const reserved = bytes <= SIZE_MAX - kPage ? mmap(nullptr, bytes + kPage, PROT_READ | PROT_WRITE,
                                                          MAP_PRIVATE | MAP_ANONYMOUS, -1, 0)
                                                   : MAP_FAILED;
  if (reserved == MAP_FAILED) {
    throw std::bad_alloc();
  }
  auto* const begin = static_cast<std::byte*>(reserved);
  const std::size_t before =
      wholePages(reinterpret_cast<std::uintptr_t>(begin)) - reinterpret_cast<std::uintptr_t>(begin);
  if (before > 0) {
    munmap(begin, before);
  }
  if (before < kPage) {
    munmap(begin + before + bytes, kPage - before);
  }
  madvise(begin + before, bytes, MADV_HUGEPAGE);  // a wish; what it returns changes nothing
  return begin + before;
}

struct Pages {
  std::byte* begin;
  std::size_t bytes;  // whole pages
};

// The free pages of a thread, and how many reuse them.
struct FreePages {
  std::vector<Pages> blocks;
  int users = 0;
};
FreePages& freePages() {
  static thread_local FreePages pages;
  return pages;
}

// Takes so many bytes, whole pages, of the last free ones, or fewer.
Pages takeLast(std::vector<Pages>& free, std::size_t bytes) {
  Pages& last = free.back();
  const std::size_t taken = std::min(bytes, last.bytes);
  last.bytes -= taken;
  const Pages pages{last.begin + last.bytes, taken};
  if (last.bytes == 0) {
    free.pop_back();
  }
  return pages;
}

std::byte* pagesFor(std::size_t bytes, std::vector<Pages>& free) {
  const auto fits = [bytes](const Pages& block) { return block.bytes >= bytes; };
  if (const auto block = std::find_if(free.begin(), free.end(), fits); block != free.end()) {
    std::swap(*block, free.back());
    return takeLast(free, bytes).begin;
  }
  std::byte* const memory = newPages(bytes);
  for (std::size_t have = 0; have < bytes && !free.empty();) {
    const Pages pages = takeLast(free, bytes - have);
    // What cannot be moved is given back: the place for it has memory anyway.
    if (mremap(pages.begin, pages.bytes, pages.bytes, MREMAP_MAYMOVE | MREMAP_FIXED, memory + have) ==
        MAP_FAILED) {
      munmap(pages.begin, pages.bytes);
    }
    have += pages.bytes;
  }
  return memory;
}

#endif

}  // namespace

#if SIGHTLINE_OWN_PAGES

void* allocateLarge(std::size_t bytes) {
  if (bytes < kLarge) {
    return ::operator new(bytes);
  }
  if (bytes > SIZE_MAX - kPage) {
    throw std::bad_alloc();
  }
  return pagesFor(wholePages(bytes), freePages().blocks);
}

void freeLarge(void* memory, std::size_t bytes) {
  if (bytes < kLarge) {
    ::operator delete(memory);
    return;
  }
  auto* const begin = static_cast<std::byte*>(memory);
  if (freePages().users > 0) {
    freePages().blocks.push_back({begin, wholePages(bytes)});
  } else {
    munmap(begin, wholePages(bytes));
  }
}

base::MemoryReuse::MemoryReuse() {
  ++freePages().users;
}

base::MemoryReuse::~MemoryReuse() {
  FreePages& free = freePages();
  if (--free.users == 0) {
    for (const Pages& pages : free.blocks) {
      munmap(pages.begin, pages.bytes);
    }
    std::vector<Pages>().swap(free.blocks);
  }
}

#else

void* allocateLarge(std::size_t bytes) {
  return bytes < kLarge ? ::operator new(bytes) : ::operator new(bytes, std::align_val_t(kPage));
}

void freeLarge(void* memory, std::size_t bytes) {
  if (bytes < kLarge) {
    ::operator delete(memory);
  } else {
    ::operator delete(memory, std::align_val_t(kPage));
  }
}

base::MemoryReuse::MemoryReuse() = default;
base::MemoryReuse::~MemoryReuse() = default;

#endif

}  // namespace sightline
