#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <list>
#include <mutex>
#include <span>
#include <type_traits>
#include <vector>

#include "src/base/scratch_array.h"

namespace sightline::base {

// Keeps what the parts of a large step find until it is put together. Much of it lies in one block of memory,
// and so in large pages, which takes a tenth of the time of as many small vectors.
class PartStore {
 public:
  // A copy of the items that stays where it is for as long as this exists. Several threads may call this.
  template <typename T>
  std::span<T> keep(const std::vector<T>& items) {
    static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= kAlignment);
    if (items.empty()) {
      return {};
    }
    const std::size_t bytes = items.size() * sizeof(T);
    T* const kept = reinterpret_cast<T*>(take(bytes));
    std::memcpy(static_cast<void*>(kept), items.data(), bytes);
    return {kept, items.size()};
  }

 private:
  static constexpr std::size_t kAlignment = alignof(std::max_align_t);
  static constexpr std::size_t kFirstBlock = std::size_t{64} << 10, kLargestBlock = std::size_t{64} << 20;

  std::byte* take(std::size_t bytes) {
    bytes = (bytes + kAlignment - 1) / kAlignment * kAlignment;
    const std::lock_guard lock(mutex_);
    if (blocks_.empty() || blocks_.back().size() - used_ < bytes) {
      const std::size_t next =
          blocks_.empty() ? kFirstBlock : std::min(kLargestBlock, 2 * blocks_.back().size());
      blocks_.emplace_back(std::max(bytes, next));
      used_ = 0;
    }
    std::byte* const taken = blocks_.back().begin() + used_;
    used_ += bytes;
    return taken;
  }

  std::mutex mutex_;
  std::list<ScratchArray<std::byte>> blocks_;
  std::size_t used_ = 0;  // bytes of the last block
};

}  // namespace sightline::base
