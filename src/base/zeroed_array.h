#pragma once

#include <cstddef>
#include <limits>
#include <type_traits>
#include <utility>

namespace sightline::base {

// More than 0 bytes, all of them zero, aligned for any type; fails as operator new does. Large memory is
// handed out page by page as it is touched, where the system can do that.
void* allocateZeroed(std::size_t bytes);
void freeZeroed(void* memory, std::size_t bytes);  // bytes: as allocated

// An array whose elements are zero until they are written. What nobody has written of a large one takes
// neither time nor space. For what is kept of a few of very many items.
template <typename T>
class ZeroedArray {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);
  static_assert(alignof(T) <= alignof(std::max_align_t));

 public:
  ZeroedArray() = default;
  ZeroedArray(const ZeroedArray&) = delete;
  ZeroedArray& operator=(const ZeroedArray&) = delete;
  ~ZeroedArray() { free(); }

  // Makes room for so many elements. All are zero again if there was less.
  void require(std::size_t size) {
    if (size > size_) {
      free();  // before there is more, so that both are never there at once
      constexpr auto kAll = static_cast<std::size_t>(std::numeric_limits<std::ptrdiff_t>::max());
      data_ = static_cast<T*>(allocateZeroed(size > kAll / sizeof(T) ? kAll : size * sizeof(T)));
      size_ = size;
    }
  }
  // All are zero again.
  void clear() {
    const std::size_t size = size_;
    free();
    require(size);
  }

  std::size_t size() const { return size_; }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }

 private:
  void free() {
    if (data_ != nullptr) {
      freeZeroed(std::exchange(data_, nullptr), std::exchange(size_, 0) * sizeof(T));
    }
  }

  std::size_t size_ = 0;
  T* data_ = nullptr;
};

}  // namespace sightline::base
