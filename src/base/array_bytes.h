#pragma once

// Arrays as bytes, for machines of the same kind: each as the number of its items and their memory, both
// padded, so that every array begins at a multiple of 16 bytes.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <utility>

#include "sightline/base/large_vector.h"

namespace sightline::base {

inline constexpr std::size_t kArrayAlignment = 16;

constexpr std::size_t paddedSize(std::size_t bytes) {
  return (bytes + kArrayAlignment - 1) / kArrayAlignment * kArrayAlignment;
}

// What comes first: it has to be the same where the arrays are read.
struct ArraysHead {
  char letters[8];      // what they are, and a version
  std::uint32_t sizes;  // of their items, put together in some way
  std::uint32_t byte_order = 0x01020304;

  friend bool operator==(const ArraysHead&, const ArraysHead&) = default;
};
static_assert(sizeof(ArraysHead) == kArrayAlignment);

class ArrayWriter {
 public:
  // size: of all that will be written.
  explicit ArrayWriter(std::size_t size) : bytes_(size) {}

  template <typename Array>
  static std::size_t sizeOf(const Array& array) {
    return kArrayAlignment + paddedSize(array.size() * sizeof(array[0]));
  }

  // Writes a value whose size is a multiple of 16 bytes.
  template <typename Value>
  void value(const Value& value) {
    static_assert(std::is_trivially_copyable_v<Value> && sizeof(Value) % kArrayAlignment == 0);
    std::memcpy(&bytes_[at_], &value, sizeof(value));
    at_ += sizeof(value);
  }
  template <typename Array>
  void array(const Array& array) {
    using Item = typename Array::value_type;
    static_assert(std::is_trivially_copyable_v<Item> && alignof(Item) <= kArrayAlignment);
    const std::uint64_t count = array.size();
    std::memcpy(&bytes_[at_], &count, sizeof(count));
    if (count > 0) {
      std::memcpy(&bytes_[at_ + kArrayAlignment], array.data(), array.size() * sizeof(Item));
    }
    at_ += sizeOf(array);
  }

  LargeVector<std::byte> take() { return std::move(bytes_); }

 private:
  LargeVector<std::byte> bytes_;
  std::size_t at_ = 0;
};

// Reads what an ArrayWriter wrote. Arrays of which something is missing are left empty.
class ArrayReader {
 public:
  // Large vectors use the bytes as they are if they have an owner, and are aligned; all others get copies.
  explicit ArrayReader(const SharedBytes& shared) : shared_(shared) {
    shares_ = shared.owner != nullptr &&
              reinterpret_cast<std::uintptr_t>(shared.bytes.data()) % kArrayAlignment == 0;
  }

  template <typename Value>
  void value(Value& value) {
    if (has(sizeof(value))) {
      std::memcpy(&value, &shared_.bytes[at_], sizeof(value));
      at_ += sizeof(value);
    }
  }
  template <typename Array>
  void array(Array& array) {
    using Item = typename Array::value_type;
    std::uint64_t count = 0;
    if (!has(kArrayAlignment)) {
      return;
    }
    std::memcpy(&count, &shared_.bytes[at_], sizeof(count));
    at_ += kArrayAlignment;
    if (count > left() / sizeof(Item) || !has(paddedSize(static_cast<std::size_t>(count) * sizeof(Item)))) {
      whole_ = false;
      return;
    }
    const std::span<const std::byte> items =
        shared_.bytes.subspan(at_, static_cast<std::size_t>(count) * sizeof(Item));
    at_ += paddedSize(items.size());
    if constexpr (std::is_same_v<Array, LargeVector<Item>>) {
      if (shares_) {
        array = vectorOver<Item>({items, shared_.owner});
        return;
      }
    }
    array.resize(static_cast<std::size_t>(count));
    if (!items.empty()) {
      std::memcpy(static_cast<void*>(array.data()), items.data(), items.size());
    }
  }

  // Whether nothing was missing, and nothing is left over.
  bool complete() const { return whole_ && left() == 0; }

 private:
  std::size_t left() const { return shared_.bytes.size() - at_; }
  bool has(std::size_t size) {
    whole_ = whole_ && size <= left();
    return whole_;
  }

  SharedBytes shared_;
  bool shares_ = false, whole_ = true;
  std::size_t at_ = 0;
};

// Whether numbers say where the rows of `items` items begin, and one more where the last one ends. They may
// be missing where there are no rows.
inline bool areRowStarts(std::span<const std::uint32_t> first, std::size_t rows, std::size_t items) {
  return (rows == 0 && items == 0 && first.empty()) ||
         (first.size() == rows + 1 && first.front() == 0 && first.back() == items &&
          std::is_sorted(first.begin(), first.end()));
}

}  // namespace sightline::base
