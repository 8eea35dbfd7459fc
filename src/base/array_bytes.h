#pragma once

// Arrays as bytes, for machines of the same kind: each as the number of its items and their memory, both
// padded, so that every array begins at a multiple of 16 bytes.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

#include "sightline/base/large_vector.h"
#include "sightline/base/result.h"

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

// What is written is arrays, whose number of items may be any, and values, whose size is a multiple of 16.
template <typename Item>
concept IsArray = requires(Item& item) {
  item.resize(std::size_t{});
};

class ArrayWriter {
 public:
  // size: of all that will be written.
  explicit ArrayWriter(std::size_t size) : bytes_(size) {}

  template <typename Item>
  static std::size_t sizeOf(const Item& item) {
    if constexpr (IsArray<Item>) {
      return kArrayAlignment + paddedSize(item.size() * sizeof(item[0]));
    } else {
      return sizeof(item);
    }
  }

  template <typename Item>
  void write(const Item& item) {
    if constexpr (IsArray<Item>) {
      using T = typename Item::value_type;
      static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= kArrayAlignment);
      const std::uint64_t count = item.size();
      std::memcpy(&bytes_[at_], &count, sizeof(count));
      if (count > 0) {
        std::memcpy(&bytes_[at_ + kArrayAlignment], item.data(), item.size() * sizeof(T));
      }
    } else {
      static_assert(std::is_trivially_copyable_v<Item> && sizeof(Item) % kArrayAlignment == 0);
      std::memcpy(&bytes_[at_], &item, sizeof(item));
    }
    at_ += sizeOf(item);
  }

  LargeVector<std::byte> take() { return std::move(bytes_); }

 private:
  LargeVector<std::byte> bytes_;
  std::size_t at_ = 0;
};

// Reads what an ArrayWriter wrote. Arrays and values of which something is missing are left as they are.
class ArrayReader {
 public:
  // Large vectors use the bytes as they are if they have an owner, and are aligned; all others get copies.
  explicit ArrayReader(const SharedBytes& shared) : shared_(shared) {
    shares_ = shared.owner != nullptr &&
              reinterpret_cast<std::uintptr_t>(shared.bytes.data()) % kArrayAlignment == 0;
  }

  template <typename Item>
  void read(Item& item) {
    if constexpr (IsArray<Item>) {
      readArray(item);
    } else if (has(sizeof(item))) {
      std::memcpy(&item, &shared_.bytes[at_], sizeof(item));
      at_ += sizeof(item);
    }
  }

  // Whether nothing was missing, and nothing is left over.
  bool complete() const { return whole_ && left() == 0; }

 private:
  template <typename Array>
  void readArray(Array& array) {
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
  std::size_t left() const { return shared_.bytes.size() - at_; }
  bool has(std::size_t size) {
    whole_ = whole_ && size <= left();
    return whole_;
  }

  SharedBytes shared_;
  bool shares_ = false, whole_ = true;
  std::size_t at_ = 0;
};

// A head, and what for_each(visit) calls visit(item) for: values and arrays, always in the same order.
template <typename ForEach>
LargeVector<std::byte> arrayBytes(const ArraysHead& head, const ForEach& for_each) {
  std::size_t size = sizeof(head);
  for_each([&](const auto& item) { size += ArrayWriter::sizeOf(item); });
  ArrayWriter writer(size);
  writer.write(head);
  for_each([&](const auto& item) { writer.write(item); });
  return writer.take();
}

// Reads what arrayBytes() wrote into the same items. name: what they are, in the plural, as errors call them.
template <typename ForEach>
Status readArrays(const SharedBytes& bytes, const ArraysHead& head, const std::string& name,
                  const ForEach& for_each) {
  if (bytes.bytes.size() < sizeof(head)) {
    return Error{"the " + name + " are cut off: find them again"};
  }
  ArrayReader reader(bytes);
  ArraysHead found{};
  reader.read(found);
  if (found != head) {
    return Error{"these are no " + name + ", or those of another version or machine: find them again"};
  }
  for_each([&](auto& item) { reader.read(item); });
  return reader.complete()
             ? Status(Success{})
             : Error{"the " + name + " are cut off, or something follows them: find them again"};
}

// The error where what was read is whole, but not what it should be.
inline Error unsoundArrays(const std::string& name, const std::string& flaw) {
  return Error{"the " + name + " are not sound, " + flaw + ": find them again"};
}

// Whether an array of this size has the items of a range.
inline bool isRange(std::uint64_t first, std::uint64_t count, std::size_t size) {
  return first <= size && count <= size - first;
}

// Whether the memory of a bool in an item is 0 or 1: as a bool, nothing else may be looked at.
template <typename Item>
bool isBoolAt(const Item& item, std::size_t offset) {
  return reinterpret_cast<const unsigned char*>(&item)[offset] <= 1;
}

// Whether numbers say where the rows of `items` items begin, and one more where the last one ends. They may
// be missing where there are no rows.
inline bool areRowStarts(std::span<const std::uint32_t> first, std::size_t rows, std::size_t items) {
  return (rows == 0 && items == 0 && first.empty()) ||
         (first.size() == rows + 1 && first.front() == 0 && first.back() == items &&
          std::is_sorted(first.begin(), first.end()));
}

}  // namespace sightline::base
