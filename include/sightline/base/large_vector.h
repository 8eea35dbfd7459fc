#pragma once

// Vectors for what grows with the scene. Where the system allows it, large ones lie in pages of 2 MiB: they
// take a fraction of the time to fill, and reading them at random misses the page tables less.

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <new>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace sightline {

// Memory aligned for any type; fails as operator new does.
void* allocateLarge(std::size_t bytes);
void freeLarge(void* memory, std::size_t bytes);  // bytes: as allocated

// Bytes that somebody else owns, such as those of a mapped file. Nobody else may change them while they are
// used. A vector over them (vectorOver) whose items are changed is changed there: map files copy-on-write.
// When another vector is copied or moved into it, they are let go; assign() and a list in braces write there.
struct SharedBytes {
  std::span<const std::byte> bytes{};
  std::shared_ptr<const void> owner{};  // the bytes are there for as long as this is
};

namespace base {

// Items of a vector that are in memory before it is.
struct GivenItems {
  std::shared_ptr<const void> owner{};
  void* begin = nullptr;
  bool taken = false;     // by the vector, which asks for memory once more if it grows
  bool complete = false;  // the vector is made: items that it adds are its own
};

}  // namespace base

template <typename T>
class LargeAllocator {
 public:
  // NOLINTBEGIN(readability-identifier-naming): the names of the standard library
  using value_type = T;
  using propagate_on_container_move_assignment = std::true_type;
  using propagate_on_container_swap = std::true_type;
  using propagate_on_container_copy_assignment = std::true_type;

  LargeAllocator() = default;
  explicit LargeAllocator(std::shared_ptr<base::GivenItems> given) : given_(std::move(given)) {}
  template <typename U>
  LargeAllocator(const LargeAllocator<U>&) {}
  LargeAllocator(const LargeAllocator&) = default;
  LargeAllocator(LargeAllocator&&) noexcept = default;
  LargeAllocator& operator=(LargeAllocator&&) noexcept = default;
  ~LargeAllocator() = default;
  // When another vector is copied into one over given items, these are let go: nothing is written there.
  LargeAllocator& operator=(const LargeAllocator& other) {
    if (this != &other) {
      given_.reset();
    }
    return *this;
  }
  // A copy of a vector has memory of its own.
  LargeAllocator select_on_container_copy_construction() const { return {}; }
  // NOLINTEND(readability-identifier-naming)

  T* allocate(std::size_t count) {
    if (given_ != nullptr && !std::exchange(given_->taken, true)) {
      return static_cast<T*>(given_->begin);
    }
    constexpr auto kAll = static_cast<std::size_t>(std::numeric_limits<std::ptrdiff_t>::max());
    return static_cast<T*>(allocateLarge(count > kAll / sizeof(T) ? kAll : count * sizeof(T)));
  }
  void deallocate(T* memory, std::size_t count) {
    if (given_ == nullptr || memory != given_->begin) {
      freeLarge(memory, count * sizeof(T));
    }
  }
  template <typename U>
  void construct(U* at) {
    if (given_ == nullptr || given_->complete) {
      ::new (static_cast<void*>(at)) U();
    }
  }

  // Never equal where items are given, not even to itself, so that a vector lets go what it has before it
  // takes a copy. No operation of std::vector relies on the rule of allocators that this breaks: all
  // propagate.
  friend bool operator==(const LargeAllocator& a, const LargeAllocator& b) {
    return a.given_ == nullptr && b.given_ == nullptr;
  }

 private:
  std::shared_ptr<base::GivenItems> given_;
};

template <typename T>
using LargeVector = std::vector<T, LargeAllocator<T>>;

// A vector of the items that the bytes hold, without a copy of them: their memory is that of the vector,
// until it grows, and changes with it. Precondition: the bytes begin where a T may, and are whole ones.
template <typename T>
LargeVector<T> vectorOver(const SharedBytes& shared) {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);
  if (shared.bytes.empty()) {
    return {};
  }
  void* const begin = const_cast<std::byte*>(shared.bytes.data());
  const auto given = std::make_shared<base::GivenItems>(base::GivenItems{shared.owner, begin});
  LargeVector<T> items(shared.bytes.size() / sizeof(T), LargeAllocator<T>(given));
  given->complete = true;
  return items;
}

}  // namespace sightline
