#pragma once

// Vectors for what grows with the scene. Where the system allows it, large ones lie in pages of 2 MiB: they
// take a fraction of the time to fill, and reading them at random misses the page tables less.

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace sightline {

// Memory aligned for any type; fails as operator new does.
void* allocateLarge(std::size_t bytes);
void freeLarge(void* memory, std::size_t bytes);  // bytes: as allocated

template <typename T>
struct LargeAllocator {
  using value_type = T;

  LargeAllocator() = default;
  template <typename U>
  LargeAllocator(const LargeAllocator<U>&) {}

  T* allocate(std::size_t count) {
    constexpr auto kAll = static_cast<std::size_t>(std::numeric_limits<std::ptrdiff_t>::max());
    return static_cast<T*>(allocateLarge(count > kAll / sizeof(T) ? kAll : count * sizeof(T)));
  }
  void deallocate(T* memory, std::size_t count) { freeLarge(memory, count * sizeof(T)); }

  template <typename U>
  friend bool operator==(const LargeAllocator&, const LargeAllocator<U>&) {
    return true;
  }
};

template <typename T>
using LargeVector = std::vector<T, LargeAllocator<T>>;

}  // namespace sightline
