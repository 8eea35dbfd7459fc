#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <type_traits>

#include "sightline/base/large_vector.h"

namespace sightline::base {

// An array whose elements have no value before the first assignment, so that memory is written once. For
// what large steps leave to the next one.
template <typename T>
class ScratchArray {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

 public:
  explicit ScratchArray(std::size_t size)
      : size_(size), data_(size > 0 ? LargeAllocator<T>().allocate(size) : nullptr) {}
  ScratchArray(const ScratchArray&) = delete;
  ScratchArray& operator=(const ScratchArray&) = delete;
  ~ScratchArray() {
    if (data_ != nullptr) {
      LargeAllocator<T>().deallocate(data_, size_);
    }
  }

  std::size_t size() const { return size_; }
  T* begin() { return data_; }
  T* end() { return data_ + size_; }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }

 private:
  std::size_t size_;
  T* data_;
};

// Frees the memory of a vector. Assigning {} to it would only empty it.
template <typename Vector>
void freeVector(Vector& vector) {
  Vector().swap(vector);
}

// A vector whose items have no value before the first assignment either: to be filled whole, at once.
template <typename T>
LargeVector<T> unsetVector(std::size_t size) {
  const auto memory = std::make_shared<ScratchArray<T>>(size);
  return vectorOver<T>({std::as_bytes(std::span(memory->begin(), size)), memory});
}

}  // namespace sightline::base
