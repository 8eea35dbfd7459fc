#include "sightline/base/large_vector.h"

#include <cstddef>
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

std::size_t wholePages(std::size_t bytes) {
  return (bytes + kPage - 1) / kPage * kPage;
}

std::byte* newBlock(std::size_t bytes) {
  void* const block = ::operator new(bytes, std::align_val_t(kPage));
#ifdef __linux__
  madvise(block, bytes, MADV_HUGEPAGE);  // a wish; what it returns changes nothing
#endif
  return static_cast<std::byte*>(block);
}

// Gives the pages of a free part of a block back to the system, which are zeros when they are used again.
void forgetPages([[maybe_unused]] std::byte* begin, [[maybe_unused]] std::size_t bytes) {
#ifdef __linux__
  madvise(begin, bytes, MADV_DONTNEED);
#endif
}

// All large memory. Blocks come from operator new and are divided for what is needed next. A block of which
// nothing is in use goes back, but not while somebody wants it to be kept. All sizes are of whole pages.
class LargeMemory {
 public:
  void keepMore() {
    const std::lock_guard lock(mutex_);
    ++keeping_;
  }
  void keepLess() {
    const std::lock_guard lock(mutex_);
    if (--keeping_ == 0) {
      for (auto range = free_.begin(); range != free_.end();) {
        range = letGo(range);
      }
    }
  }
  // The smallest free range that is large enough serves, or else a new block.
  std::byte* allocate(std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    auto best = free_.end();
    for (auto range = free_.begin(); range != free_.end(); ++range) {
      if (range->second >= bytes && (best == free_.end() || range->second < best->second)) {
        best = range;
      }
    }
    if (best == free_.end()) {
      std::byte* const block = newBlock(bytes);
      blocks_.emplace(block, bytes);
      return block;
    }
    const auto [begin, size] = *best;
    free_.erase(best);
    if (size > bytes) {
      free_.emplace(begin + bytes, size - bytes);
    }
    return begin;
  }
  void free(std::byte* begin, std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    auto range = free_.emplace(begin, bytes).first;
    if (const auto next = std::next(range); next != free_.end()) {
      joinIfTheyTouch(range, next);
    }
    if (range != free_.begin()) {
      const auto before = std::prev(range);
      range = joinIfTheyTouch(before, range) ? before : range;
    }
    if (keeping_ == 0) {
      letGo(range);
    }
  }

 private:
  using Ranges = std::map<std::byte*, std::size_t>;  // begin and size

  // Makes the first of two ranges of one block hold the second one as well, if it begins where that ends.
  bool joinIfTheyTouch(Ranges::iterator first, Ranges::iterator second) {
    if (first->first + first->second != second->first || blocks_.count(second->first) > 0) {
      return false;
    }
    first->second += second->second;
    free_.erase(second);
    return true;
  }
  // Gives back a block that is all free, or else the pages of the range. Returns the range after it.
  Ranges::iterator letGo(Ranges::iterator range) {
    const auto block = blocks_.find(range->first);
    if (block == blocks_.end() || block->second != range->second) {
      forgetPages(range->first, range->second);
      return std::next(range);
    }
    ::operator delete(block->first, std::align_val_t(kPage));
    blocks_.erase(block);
    return free_.erase(range);
  }

  std::mutex mutex_;
  std::size_t keeping_ = 0;  // how many want free memory to be kept
  Ranges blocks_;
  Ranges free_;  // parts of blocks, no two of which touch in the same block
};

// It is never destroyed, because vectors may be destroyed after all else.
LargeMemory& largeMemory() {
  static LargeMemory& memory = *new LargeMemory;
  return memory;
}

}  // namespace

void* allocateLarge(std::size_t bytes) {
  if (bytes < kLarge) {
    return ::operator new(bytes);
  }
  if (bytes > wholePages(bytes)) {
    return ::operator new(bytes);  // which fails: there is no number for so many whole pages
  }
  return largeMemory().allocate(wholePages(bytes));
}

void freeLarge(void* memory, std::size_t bytes) {
  if (bytes < kLarge) {
    ::operator delete(memory);
  } else {
    largeMemory().free(static_cast<std::byte*>(memory), wholePages(bytes));
  }
}

base::MemoryReuse::MemoryReuse() {
  largeMemory().keepMore();
}
base::MemoryReuse::~MemoryReuse() {
  largeMemory().keepLess();
}

}  // namespace sightline
