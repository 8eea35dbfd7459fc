#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <memory>
#include <mutex>
#include <span>
#include <type_traits>
#include <vector>

#include "src/base/scratch_array.h"

namespace sightline::base {

// Items that stay where they are for as long as this, or a copy of it, exists.
template <typename T>
struct KeptItems {
  std::span<T> items;
  std::shared_ptr<const void> memory;
};

// Keeps what the parts of a large step find until it is put together. Much of it lies in one block of memory,
// and so in large pages, which takes a tenth of the time of as many small vectors. A block is freed with the
// last items in it, so that what is put together part by part needs hardly more memory than once.
class PartStore {
 public:
  // A copy of the items, which needs this no longer. Several threads may call this.
  template <typename T>
  KeptItems<T> keep(const std::vector<T>& items) {
    static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= kAlignment);
    if (items.empty()) {
      return {};
    }
    const std::size_t bytes = items.size() * sizeof(T);
    const KeptItems<std::byte> taken = take(bytes);
    T* const kept = reinterpret_cast<T*>(taken.items.data());
    std::memcpy(static_cast<void*>(kept), items.data(), bytes);
    return {{kept, items.size()}, taken.memory};
  }

 private:
  static constexpr std::size_t kAlignment = alignof(std::max_align_t);
  static constexpr std::size_t kFirstBlock = std::size_t{64} << 10, kLargestBlock = std::size_t{64} << 20;

  KeptItems<std::byte> take(std::size_t bytes) {
    bytes = (bytes + kAlignment - 1) / kAlignment * kAlignment;
    const std::lock_guard lock(mutex_);
    if (block_ == nullptr || block_->size() - used_ < bytes) {
      const std::size_t next = block_ == nullptr ? kFirstBlock : std::min(kLargestBlock, 2 * block_->size());
      block_ = std::make_shared<ScratchArray<std::byte>>(std::max(bytes, next));
      used_ = 0;
    }
    std::byte* const taken = block_->begin() + used_;
    used_ += bytes;
    return {{taken, bytes}, block_};
  }

  std::mutex mutex_;
  std::shared_ptr<ScratchArray<std::byte>> block_;  // the last one
  std::size_t used_ = 0;                            // bytes of it
};

}  // namespace sightline::base
