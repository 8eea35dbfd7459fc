#pragma once

// Whole numbers that are large enough for what is computed exactly of coordinates.
//
// A floating-point coordinate is a whole number times a power of two. With one power for all of them, a
// Lattice, the coordinates are whole numbers, and sums and products of them are exact. A polynomial of degree
// d in them is a Whole<d>, which holds it without allocating: terms of the same degree may be added, and the
// product of a Whole<a> and a Whole<b> is a Whole<a + b>.
//
// The whole numbers of any size that the oracle takes from Boost would do, but the runtime needs no library
// beside Highway, and knowing the degree keeps every number on the stack.

#include <algorithm>
#include <cstdint>
#include <span>

#include "sightline/math/vec3.h"

namespace sightline::geometry {

// Coordinates have no bit below 2^-149, the lowest of single precision, and are less than 2^64. So they have
// at most 213 bits, and differences of them 214. Two more for each factor cover the sums of up to 64 terms.
inline constexpr int kLowestExponent = -149, kHighestExponent = 64;
inline constexpr int kBitsOfFactor = kHighestExponent - kLowestExponent + 3;

// Magnitudes of numbers.
struct Words {
  // Numbers are little-endian words without leading zeros; zero has none. What is returned is the number of
  // words.
  static std::uint32_t add(const std::uint64_t* a, std::uint32_t a_count, const std::uint64_t* b,
                           std::uint32_t b_count, std::uint64_t* sum);
  // a >= b. `difference` may be a.
  static std::uint32_t subtract(const std::uint64_t* a, std::uint32_t a_count, const std::uint64_t* b,
                                std::uint32_t b_count, std::uint64_t* difference);
  static std::uint32_t multiply(const std::uint64_t* a, std::uint32_t a_count, const std::uint64_t* b,
                                std::uint32_t b_count, std::uint64_t* product);
  static int compare(const std::uint64_t* a, std::uint32_t a_count, const std::uint64_t* b,
                     std::uint32_t b_count);
};

template <int kDegree>
class Whole {
 public:
  static constexpr int kCapacity = (kDegree * kBitsOfFactor + 63) / 64 + 1;

  Whole() = default;  // zero
  explicit Whole(std::int64_t value) : sign_(value < 0 ? -1 : value > 0 ? 1 : 0), count_(value == 0 ? 0 : 1) {
    words_[0] = value < 0 ? -static_cast<std::uint64_t>(value) : static_cast<std::uint64_t>(value);
  }
  Whole(const Whole& other) { *this = other; }
  Whole& operator=(const Whole& other) {  // NOLINT: of itself, it copies words onto themselves
    sign_ = other.sign_;
    count_ = other.count_;
    copyWords(other.words_);
    return *this;
  }
  // A number of lower degree.
  template <int kLower>
  requires(kLower < kDegree) Whole(const Whole<kLower>& other)
      : sign_(other.sign_), count_(other.count_) {  // NOLINT: widens silently
    copyWords(other.words_);
  }

  int sign() const { return sign_; }
  std::uint32_t wordCount() const { return count_; }
  const std::uint64_t* words() const { return words_; }  // little-endian, of the magnitude

  Whole operator-() const {
    Whole negative = *this;
    negative.sign_ = -sign_;
    return negative;
  }
  friend Whole operator+(const Whole& a, const Whole& b) { return sum(a, b, b.sign_); }
  friend Whole operator-(const Whole& a, const Whole& b) { return sum(a, b, -b.sign_); }
  template <int kOther>
  Whole<kDegree + kOther> operator*(const Whole<kOther>& b) const {
    Whole<kDegree + kOther> product;
    product.sign_ = sign_ * b.sign_;
    if (product.sign_ != 0) {
      product.count_ = Words::multiply(words_, count_, b.words_, b.count_, product.words_);
    }
    return product;
  }
  // This number times 2^bits; the product must be less than 2^(64 kCapacity).
  Whole shifted(std::uint32_t bits) const {
    Whole high = *this;
    const std::uint32_t whole_words = bits / 64, rest = bits % 64;
    if (count_ == 0 || bits == 0) {
      return high;
    }
    std::copy_backward(words_, words_ + count_, high.words_ + whole_words + count_);
    std::fill_n(high.words_, whole_words, std::uint64_t{0});
    high.count_ = whole_words + count_;
    if (rest != 0) {
      std::uint64_t carry = 0;
      for (std::uint32_t i = whole_words; i < high.count_; ++i) {
        const std::uint64_t word = high.words_[i];
        high.words_[i] = word << rest | carry;
        carry = word >> (64 - rest);
      }
      if (carry != 0) {
        high.words_[high.count_++] = carry;
      }
    }
    return high;
  }

  friend int compare(const Whole& a, const Whole& b) {
    return a.sign_ != b.sign_ ? (a.sign_ < b.sign_ ? -1 : 1)
                              : a.sign_ * Words::compare(a.words_, a.count_, b.words_, b.count_);
  }
  friend bool operator==(const Whole& a, const Whole& b) { return compare(a, b) == 0; }

 private:
  template <int>
  friend class Whole;

  // Word by word: most numbers have few.
  void copyWords(const std::uint64_t* from) {
    for (std::uint32_t i = 0; i < count_; ++i) {
      words_[i] = from[i];
    }
  }

  static Whole sum(const Whole& a, const Whole& b, std::int32_t sign_of_b) {
    Whole result;
    if (a.sign_ == 0 || sign_of_b == 0) {
      result = sign_of_b == 0 ? a : b;
      result.sign_ = sign_of_b == 0 ? a.sign_ : sign_of_b;
    } else if (a.sign_ == sign_of_b) {
      result.sign_ = a.sign_;
      result.count_ = Words::add(a.words_, a.count_, b.words_, b.count_, result.words_);
    } else if (const int order = Words::compare(a.words_, a.count_, b.words_, b.count_); order > 0) {
      result.sign_ = a.sign_;
      result.count_ = Words::subtract(a.words_, a.count_, b.words_, b.count_, result.words_);
    } else if (order < 0) {
      result.sign_ = sign_of_b;
      result.count_ = Words::subtract(b.words_, b.count_, a.words_, a.count_, result.words_);
    }
    return result;
  }

  std::int32_t sign_ = 0;    // -1, 0 or 1
  std::uint32_t count_ = 0;  // words in use
  std::uint64_t words_[kCapacity];
};

template <int kDegree>
struct WholeVec {
  Whole<kDegree> x, y, z;

  const Whole<kDegree>& operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  friend WholeVec operator+(const WholeVec& a, const WholeVec& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend WholeVec operator-(const WholeVec& a, const WholeVec& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
};

template <int kA, int kB>
WholeVec<kA + kB> operator*(const WholeVec<kA>& a, const Whole<kB>& factor) {
  return {a.x * factor, a.y * factor, a.z * factor};
}
template <int kA, int kB>
Whole<kA + kB> dot(const WholeVec<kA>& a, const WholeVec<kB>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <int kA, int kB>
WholeVec<kA + kB> cross(const WholeVec<kA>& a, const WholeVec<kB>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// The whole multiples of 2^exponent.
class Lattice {
 public:
  // The lattice of all coordinates that are allowed().
  static Lattice of(std::span<const Vec3d> points);

  // Whether the bits of a coordinate lie between the two exponents above.
  static bool allowed(double coordinate);
  static bool allowed(const Vec3d& point) { return allowed(point.x) && allowed(point.y) && allowed(point.z); }
  // The exponent of the lowest bit that is set in a finite number; a large one for zero.
  static int lowestExponent(double value);

  int exponent() const { return exponent_; }
  double units() const { return units_; }  // of the lattice in a metre, 2^-exponent
  Whole<1> whole(double coordinate) const;
  WholeVec<1> whole(const Vec3d& point) const { return {whole(point.x), whole(point.y), whole(point.z)}; }

 private:
  int exponent_ = 0;
  double units_ = 1.0;
};

struct RoundedQuotient {
  double value = 0.0;  // the nearest number in double precision, the even one of two
  double error = 0.0;  // at least how far it is off; 0 if it is exact
};

// a / b * 2^exponent, b > 0. It depends on nothing but the value of this quotient, and is monotonic in it.
RoundedQuotient roundQuotient(const Whole<7>& a, const Whole<6>& b, int exponent);

}  // namespace sightline::geometry
