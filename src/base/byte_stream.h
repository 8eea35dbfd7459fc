#pragma once

// Numbers as little-endian bytes, on every platform the same, and back. The reader is for bytes of any
// origin: it never reads beyond them and allocates no more than they can fill.

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace sightline::base {

template <typename T>
concept ByteNumber =
    (std::integral<T> && !std::same_as<T, bool>) || std::same_as<T, float> || std::same_as<T, double>;

template <ByteNumber T>
std::uint64_t bitsOf(T value) {
  if constexpr (std::same_as<T, float>) {
    return std::bit_cast<std::uint32_t>(value);
  } else if constexpr (std::same_as<T, double>) {
    return std::bit_cast<std::uint64_t>(value);
  } else {
    return static_cast<std::make_unsigned_t<T>>(value);
  }
}

template <ByteNumber T>
T numberOf(std::uint64_t bits) {
  if constexpr (std::same_as<T, float>) {
    return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
  } else if constexpr (std::same_as<T, double>) {
    return std::bit_cast<double>(bits);
  } else {
    return static_cast<T>(static_cast<std::make_unsigned_t<T>>(bits));
  }
}

class ByteWriter {
 public:
  void reserve(std::size_t bytes) { bytes_.reserve(bytes); }
  std::size_t size() const { return bytes_.size(); }

  template <ByteNumber T>
  void add(T value) {
    const std::uint64_t bits = bitsOf(value);
    const std::size_t at = bytes_.size();
    bytes_.resize(at + sizeof(T));
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      bytes_[at + i] = static_cast<std::byte>(bits >> 8 * i & 0xff);
    }
  }
  // One after the other, without their number.
  template <ByteNumber T>
  void addAll(std::span<const T> values) {
    for (const T value : values) {
      add(value);
    }
  }
  void addBytes(std::span<const std::byte> bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }

  // Leaves this empty.
  std::vector<std::byte> take() { return std::exchange(bytes_, {}); }

 private:
  std::vector<std::byte> bytes_;
};

// What it reads is not copied and has to outlive it.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  // False once something was read that is not there: from then on every read gives zero or nothing.
  bool ok() const { return ok_; }
  // Where the next read begins; if not ok(), where the first one began that failed.
  std::size_t position() const { return position_; }
  std::size_t remaining() const { return bytes_.size() - position_; }
  bool atEnd() const { return ok_ && remaining() == 0; }
  // Fails where fewer things of this size (more than 0) are to come; reads nothing.
  void expect(std::uint64_t count, std::size_t bytes_each) {
    if (count > remaining() / bytes_each) {
      ok_ = false;
    }
  }

  template <ByteNumber T>
  T read() {
    return take(1, sizeof(T)) ? numberAt<T>(position_ - sizeof(T)) : T{};
  }
  // So many numbers, or none.
  template <ByteNumber T>
  std::vector<T> readAll(std::uint64_t count) {
    std::vector<T> values;
    const std::size_t begin = position_;
    if (take(count, sizeof(T))) {
      values.reserve(static_cast<std::size_t>(count));
      for (std::size_t at = begin; at < position_; at += sizeof(T)) {
        values.push_back(numberAt<T>(at));
      }
    }
    return values;
  }
  // Not copied. So many, or none.
  std::span<const std::byte> readBytes(std::uint64_t count) {
    const std::size_t begin = position_;
    return take(count, 1) ? bytes_.subspan(begin, position_ - begin) : std::span<const std::byte>();
  }
  // A number of things to follow, each of so many bytes at least (more than 0). Fails where the rest is too
  // short for them, so that a container of that size is justified by the bytes; then 0.
  template <std::unsigned_integral T>
  T readCount(std::size_t bytes_each) {
    const std::size_t begin = position_;
    const T count = read<T>();
    expect(count, bytes_each);
    if (!ok_) {
      position_ = begin;
      return 0;
    }
    return count;
  }

 private:
  // Moves past so many things of this size, if they are there.
  bool take(std::uint64_t count, std::size_t bytes_each) {
    expect(count, bytes_each);
    if (ok_) {
      position_ += static_cast<std::size_t>(count) * bytes_each;
    }
    return ok_;
  }

  template <ByteNumber T>
  T numberAt(std::size_t position) const {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      bits |= static_cast<std::uint64_t>(bytes_[position + i]) << 8 * i;
    }
    return numberOf<T>(bits);
  }

  std::span<const std::byte> bytes_;
  std::size_t position_ = 0;
  bool ok_ = true;
};

}  // namespace sightline::base
