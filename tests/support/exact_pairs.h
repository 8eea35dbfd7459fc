#pragma once

// Exact tests of whether convex hulls intersect, and whether one occludes another: the reference for the
// tests of visibility sorting. Shares no code with the library.
//
// Hulls of points a and b intersect if sum l_i a_i = sum m_j b_j has a solution with l, m >= 0 and sums of 1:
// a linear program with five rows. Its first phase is solved by the simplex method with Bland's rule (which
// terminates), in integers: all coordinates are multiples of one power of two, and the entries of a tableau
// stay integers if they are multiplied by the last pivot (Edmonds). Fast enough for a few dozen points.

#include <algorithm>
#include <array>
#include <bit>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "sightline/math/vec3.h"

namespace sightline::test {

using Whole = boost::multiprecision::cpp_int;
using Exact = boost::multiprecision::cpp_rational;

inline Exact exactDot(const Vec3d& a, const Vec3d& b) {
  return Exact(a.x) * Exact(b.x) + Exact(a.y) * Exact(b.y) + Exact(a.z) * Exact(b.z);
}

// Six times the volume of the tetrahedron: positive if d sees a, b, c clockwise, that is, is behind them.
inline Exact exactVolume(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  using Row = std::array<Exact, 3>;
  const auto less = [&d](const Vec3d& p) {
    return Row{Exact(p.x) - Exact(d.x), Exact(p.y) - Exact(d.y), Exact(p.z) - Exact(d.z)};
  };
  const Row u = less(a);
  const Row v = less(b);
  const Row w = less(c);
  return u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) +
         u[2] * (v[0] * w[1] - v[1] * w[0]);
}

// Is there x >= 0 with columns * x = right_side >= 0?
template <std::size_t kRows>
class Feasibility {
 public:
  using Column = std::array<Whole, kRows>;

  explicit Feasibility(std::vector<Column> columns, const Column& right_side) : table_(std::move(columns)) {
    table_.push_back(right_side);
    for (std::size_t row = 0; row < kRows; ++row) {
      basis_[row] = table_.size() + row;  // the artificial variable of the row
    }
    for (const Column& column : table_) {
      Whole sum = 0;
      for (const Whole& entry : column) {
        sum += entry;
      }
      gain_.push_back(sum);
    }
  }

  bool solve() {
    while (gain_.back() > 0) {
      const std::optional<std::size_t> column = entering();
      if (!column) {
        return false;
      }
      pivot(leaving(*column), *column);
    }
    return true;
  }

 private:
  std::optional<std::size_t> entering() const {
    for (std::size_t i = 0; i + 1 < table_.size(); ++i) {
      if (gain_[i] > 0) {
        return i;
      }
    }
    return std::nullopt;
  }

  // The row with the minimum of right side / entry among the positive entries. One exists, because the sum of
  // the artificial variables is bounded below.
  std::size_t leaving(std::size_t column) const {
    std::size_t best = kRows;
    const Column& right = table_.back();
    for (std::size_t row = 0; row < kRows; ++row) {
      if (table_[column][row] <= 0) {
        continue;
      }
      if (best == kRows) {
        best = row;
        continue;
      }
      const Whole here = right[row] * table_[column][best];
      const Whole there = right[best] * table_[column][row];
      if (here < there || (here == there && basis_[row] < basis_[best])) {
        best = row;
      }
    }
    return best;
  }

  void pivot(std::size_t pivot_row, std::size_t pivot_column) {
    const Column by = table_[pivot_column];
    const Whole gain_by = gain_[pivot_column];
    const Whole& at = by[pivot_row];
    for (std::size_t i = 0; i < table_.size(); ++i) {
      Column& column = table_[i];
      for (std::size_t row = 0; row < kRows; ++row) {
        if (row != pivot_row) {
          column[row] = (column[row] * at - by[row] * column[pivot_row]) / scale_;
        }
      }
      gain_[i] = (gain_[i] * at - gain_by * column[pivot_row]) / scale_;
    }
    scale_ = at;
    basis_[pivot_row] = pivot_column;
  }

  std::vector<Column> table_;  // entries times scale_; the last column is the right side
  std::vector<Whole> gain_;    // decrease of the sum of artificial variables, times scale_
  std::array<std::size_t, kRows> basis_{};
  Whole scale_ = 1;
};

// Scales vectors by the least power of two that makes all coordinates integers. Small integers stay small, so
// that the tableau's entries take one or two words.
class WholeVectors {
 public:
  void add(const Vec3d& v) {
    for (int axis = 0; axis < 3; ++axis) {
      if (v[axis] != 0.0) {
        const int exponent = lowestBit(v[axis]);
        const auto digits = static_cast<std::uint64_t>(std::abs(digitsOf(v[axis], exponent)));
        lowest_ = std::min(lowest_, exponent + std::countr_zero(digits));
      }
    }
  }
  void add(std::span<const Vec3d> vectors) {
    for (const Vec3d& v : vectors) {
      add(v);
    }
  }
  Whole whole(double value) const {
    if (value == 0.0) {
      return 0;
    }
    const int exponent = lowestBit(value);
    const std::int64_t digits = digitsOf(value, exponent);
    return exponent >= lowest_ ? Whole(digits) << static_cast<unsigned>(exponent - lowest_)
                               : Whole(digits / (std::int64_t{1} << (lowest_ - exponent)));  // without a rest
  }

 private:
  // The exponent of the last bit of the mantissa.
  static int lowestBit(double value) { return std::ilogb(value) - 52; }
  static std::int64_t digitsOf(double value, int exponent) {
    return static_cast<std::int64_t>(std::ldexp(value, -exponent));
  }

  int lowest_ = 0;
};

// True if the hull of a intersects the hull of b swept along all t * ray, t >= 0.
inline bool hullMeetsSwept(std::span<const Vec3d> a, std::span<const Vec3d> b,
                           const std::optional<Vec3d>& ray) {
  WholeVectors whole;
  whole.add(a);
  whole.add(b);
  if (ray) {
    whole.add(*ray);
  }
  using Programme = Feasibility<5>;
  std::vector<Programme::Column> columns;
  for (const Vec3d& p : a) {
    columns.push_back({whole.whole(p.x), whole.whole(p.y), whole.whole(p.z), 1, 0});
  }
  for (const Vec3d& p : b) {
    columns.push_back({-whole.whole(p.x), -whole.whole(p.y), -whole.whole(p.z), 0, 1});
  }
  if (ray) {
    columns.push_back({-whole.whole(ray->x), -whole.whole(ray->y), -whole.whole(ray->z), 0, 0});
  }
  return Programme(std::move(columns), {0, 0, 0, 1, 1}).solve();
}

// Returns whether two closed convex hulls have a point in common, which touching ones have and empty ones
// have not.
inline bool convexHullsIntersect(std::span<const Vec3d> a, std::span<const Vec3d> b) {
  return hullMeetsSwept(a, b, std::nullopt);
}

inline bool inConvexHull(const Vec3d& point, std::span<const Vec3d> points) {
  return convexHullsIntersect(std::span(&point, 1), points);
}

// True if a ray from the eye hits the hull of `front` and then, or at the same point, that of `back`.
inline bool occludesExactly(std::span<const Vec3d> front, std::span<const Vec3d> back, const Vec3d& eye) {
  std::vector<Vec3d> shadowed(back.begin(), back.end());
  shadowed.push_back(eye);
  return convexHullsIntersect(front, shadowed);
}

// The same for an eye infinitely far away in a direction (any length > 0).
inline bool occludesExactlyTowards(std::span<const Vec3d> front, std::span<const Vec3d> back,
                                   const Vec3d& towards_eye) {
  return hullMeetsSwept(front, back, towards_eye);
}

}  // namespace sightline::test
