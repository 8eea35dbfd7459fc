#include "src/geometry/whole.h"

#include <bit>
#include <cmath>
#include <limits>

namespace sightline::geometry {
namespace {

__extension__ using DoubleWord = unsigned __int128;

std::uint32_t withoutZeros(const std::uint64_t* a, std::uint32_t count) {
  while (count > 0 && a[count - 1] == 0) {
    --count;
  }
  return count;
}

}  // namespace

std::uint32_t Words::add(const std::uint64_t* a, std::uint32_t a_count, const std::uint64_t* b,
                         std::uint32_t b_count, std::uint64_t* sum) {
  if (a_count < b_count) {
    std::swap(a, b);
    std::swap(a_count, b_count);
  }
  std::uint64_t carry = 0;
  for (std::uint32_t i = 0; i < a_count; ++i) {
    const DoubleWord word = DoubleWord{a[i]} + (i < b_count ? b[i] : 0) + carry;
    sum[i] = static_cast<std::uint64_t>(word);
    carry = static_cast<std::uint64_t>(word >> 64);
  }
  if (carry != 0) {
    sum[a_count++] = carry;
  }
  return a_count;
}

std::uint32_t Words::subtract(const std::uint64_t* a, std::uint32_t a_count, const std::uint64_t* b,
                              std::uint32_t b_count, std::uint64_t* difference) {
  std::uint64_t borrow = 0;
  for (std::uint32_t i = 0; i < a_count; ++i) {
    const DoubleWord word = DoubleWord{a[i]} - (i < b_count ? b[i] : 0) - borrow;
    difference[i] = static_cast<std::uint64_t>(word);
    borrow = static_cast<std::uint64_t>(word >> 64) & 1;
  }
  return withoutZeros(difference, a_count);
}

std::uint32_t Words::multiply(const std::uint64_t* a, std::uint32_t a_count, const std::uint64_t* b,
                              std::uint32_t b_count, std::uint64_t* product) {
  std::fill_n(product, a_count + b_count, std::uint64_t{0});
  for (std::uint32_t i = 0; i < a_count; ++i) {
    std::uint64_t carry = 0;
    for (std::uint32_t k = 0; k < b_count; ++k) {
      const DoubleWord word = DoubleWord{a[i]} * b[k] + product[i + k] + carry;
      product[i + k] = static_cast<std::uint64_t>(word);
      carry = static_cast<std::uint64_t>(word >> 64);
    }
    product[i + b_count] = carry;
  }
  return withoutZeros(product, a_count + b_count);
}

int Words::compare(const std::uint64_t* a, std::uint32_t a_count, const std::uint64_t* b,
                   std::uint32_t b_count) {
  if (a_count != b_count) {
    return a_count < b_count ? -1 : 1;
  }
  for (std::uint32_t i = a_count; i-- > 0;) {
    if (a[i] != b[i]) {
      return a[i] < b[i] ? -1 : 1;
    }
  }
  return 0;
}

namespace {

template <int kDegree>
int bitsOf(const Whole<kDegree>& a) {
  return a.sign() == 0
             ? 0
             : static_cast<int>(64 * a.wordCount()) - std::countl_zero(a.words()[a.wordCount() - 1]);
}

// The mantissa of a finite number, not zero, as a whole number, and its exponent.
std::int64_t mantissaOf(double value, int& exponent) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  const auto biased = static_cast<int>(bits >> 52 & 0x7ff);
  const auto fraction = static_cast<std::int64_t>(bits & 0xfffffffffffffull);
  exponent = std::max(biased, 1) - 1075;
  const std::int64_t mantissa = biased == 0 ? fraction : fraction | std::int64_t{1} << 52;
  return value < 0.0 ? -mantissa : mantissa;
}

}  // namespace

Lattice Lattice::of(std::span<const Vec3d> points) {
  Lattice lattice;
  lattice.exponent_ = kHighestExponent;
  for (const Vec3d& point : points) {
    for (int axis = 0; axis < 3; ++axis) {
      if (allowed(point[axis])) {
        lattice.exponent_ = std::min(lattice.exponent_, lowestExponent(point[axis]));
      }
    }
  }
  lattice.units_ = std::ldexp(1.0, -lattice.exponent_);
  return lattice;
}

int Lattice::lowestExponent(double value) {
  if (value == 0.0) {
    return std::numeric_limits<int>::max() / 4;
  }
  int exponent = 0;
  const std::int64_t mantissa = mantissaOf(value, exponent);
  return exponent + std::countr_zero(static_cast<std::uint64_t>(mantissa));
}

bool Lattice::allowed(double coordinate) {
  // 2^64 itself is the first number that is too large.
  return std::abs(coordinate) < 0x1p64 && lowestExponent(coordinate) >= kLowestExponent;
}

Whole<1> Lattice::whole(double coordinate) const {
  if (coordinate == 0.0) {
    return {};
  }
  int exponent = 0;
  const std::int64_t mantissa = mantissaOf(coordinate, exponent);
  const int shift = exponent - exponent_;
  // The lattice holds the coordinate, so no bit is lost to the right.
  return shift < 0 ? Whole<1>(mantissa / (std::int64_t{1} << -shift))
                   : Whole<1>(mantissa).shifted(static_cast<std::uint32_t>(shift));
}

RoundedQuotient roundQuotient(const Whole<7>& a, const Whole<6>& b, int exponent) {
  if (a.sign() == 0) {
    return {};
  }
  // Two shifts make b's highest bit that of a word, and the quotient 55 or 56 bits long.
  const int lift = static_cast<int>(64 * b.wordCount()) - bitsOf(b);
  int scale = 55 - (bitsOf(a) - bitsOf(b));
  const int a_shift = lift + scale;
  // Where a is far longer than b, b is made longer by whole words.
  const int b_words = a_shift < 0 ? (-a_shift + 63) / 64 : 0;
  const Whole<14> high = Whole<14>(a).shifted(static_cast<std::uint32_t>(a_shift + 64 * b_words));
  const Whole<14> low = Whole<14>(b).shifted(static_cast<std::uint32_t>(lift + 64 * b_words));
  // One step of long division: the quotient of the highest words is at most two too large (Knuth, The Art of
  // Computer Programming 2, 4.3.1, theorem B).
  const std::uint32_t count = low.wordCount();
  std::uint64_t rest[Whole<14>::kCapacity + 1] = {}, product[Whole<14>::kCapacity + 1];
  std::copy_n(high.words(), high.wordCount(), rest);
  DoubleWord guess = (DoubleWord{rest[count]} << 64 | rest[count - 1]) / low.words()[count - 1];
  guess = std::min(guess, DoubleWord{std::numeric_limits<std::uint64_t>::max()});
  std::uint64_t quotient = static_cast<std::uint64_t>(guess);
  std::uint32_t product_count = Words::multiply(low.words(), count, &quotient, 1, product);
  while (Words::compare(product, product_count, high.words(), high.wordCount()) > 0) {
    product_count = Words::subtract(product, product_count, low.words(), count, product);
    --quotient;
  }
  const bool inexact = Words::compare(product, product_count, high.words(), high.wordCount()) != 0;
  const int dropped_bits = 64 - std::countl_zero(quotient) - 53;
  const std::uint64_t dropped = quotient & ((std::uint64_t{1} << dropped_bits) - 1);
  const std::uint64_t half = std::uint64_t{1} << (dropped_bits - 1);
  std::uint64_t mantissa = quotient >> dropped_bits;
  if (dropped > half || (dropped == half && (inexact || (mantissa & 1) != 0))) {
    ++mantissa;
  }
  const int last_bit = dropped_bits - scale + exponent;
  RoundedQuotient result;
  result.value = a.sign() * std::ldexp(static_cast<double>(mantissa), last_bit);
  // Half of the last bit; below the normal numbers the rounding of ldexp() adds as much again.
  result.error = inexact || dropped != 0 || last_bit < -1074
                     ? std::max(std::ldexp(1.0, last_bit - 1), std::numeric_limits<double>::denorm_min())
                     : 0.0;
  return result;
}

}  // namespace sightline::geometry
