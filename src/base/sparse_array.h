#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace sightline::base {

// An array whose elements are those of a default T until they are changed. Memory is written in short runs,
// when one of their elements is first asked for: so what nobody asks for of a large array takes hardly any
// time, and no space where the system hands out pages as they are touched. For what is kept of a few of very
// many items, by one thread.
template <typename T>
class SparseArray {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);
  static_assert(alignof(T) <= __STDCPP_DEFAULT_NEW_ALIGNMENT__);

 public:
  // Makes room for so many elements. All are default ones again if there was less.
  void require(std::size_t size) {
    if (size > size_) {
      constexpr auto kAll = static_cast<std::size_t>(std::numeric_limits<std::ptrdiff_t>::max());
      std::unique_ptr<T, Delete> more(
          static_cast<T*>(::operator new(size > kAll / sizeof(T) ? kAll : size * sizeof(T))));
      set_.assign((size - 1) / kRun + 1, 0);
      data_ = std::move(more);
      size_ = size;
    }
  }
  // All are default ones again.
  void clear() { std::fill(set_.begin(), set_.end(), std::uint8_t{0}); }

  std::size_t size() const { return size_; }
  T& operator[](std::size_t i) {
    const std::size_t run = i / kRun;
    if (set_[run] == 0) {
      set_[run] = 1;
      std::uninitialized_fill_n(data_.get() + run * kRun, std::min(kRun, size_ - run * kRun), T());
    }
    return data_.get()[i];
  }

 private:
  static constexpr std::size_t kRun = 64;

  struct Delete {
    void operator()(T* memory) const { ::operator delete(memory); }
  };

  std::unique_ptr<T, Delete> data_;
  std::size_t size_ = 0;
  std::vector<std::uint8_t> set_;  // by run: its elements have values
};

}  // namespace sightline::base
