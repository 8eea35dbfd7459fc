#include "src/layers/pairs/exact_volume.h"

#include <array>
#include <cmath>
#include <cstddef>

namespace sightline::layers {
namespace {

// An exact sum of doubles: components that do not overlap, ascending in magnitude, none of them zero.
class Expansion {
 public:
  void add(double value) {
    double carry = value;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      const double sum = carry + components_[i];
      const double second = sum - carry;
      const double lost = (carry - (sum - second)) + (components_[i] - second);
      carry = sum;
      if (lost != 0.0) {
        components_[kept++] = lost;
      }
    }
    if (carry != 0.0) {
      components_[kept++] = carry;
    }
    count_ = kept;
  }

  void addProduct(double a, double b) {
    // Veltkamp's split and Dekker's product: a * b = high + low exactly.
    constexpr double kSplit = 134217729.0;  // 2^27 + 1
    const double high = a * b;
    const double a_wide = kSplit * a;
    const double a_high = a_wide - (a_wide - a);
    const double a_low = a - a_high;
    const double b_wide = kSplit * b;
    const double b_high = b_wide - (b_wide - b);
    const double b_low = b - b_high;
    const double low = a_low * b_low - (((high - a_high * b_high) - a_low * b_high) - a_high * b_low);
    add(low);
    add(high);
  }

  void addProduct(const Expansion& a, const Expansion& b, double sign) {
    for (std::size_t i = 0; i < a.count_; ++i) {
      for (std::size_t j = 0; j < b.count_; ++j) {
        addProduct(sign * a.components_[i], b.components_[j]);
      }
    }
  }

  double value() const {
    double sum = 0.0;
    for (std::size_t i = 0; i < count_; ++i) {
      sum += components_[i];
    }
    return sum;
  }

 private:
  // A difference has 2 components, a product of two 8, a minor 16, times a difference 64, three of them 192.
  std::array<double, 200> components_;
  std::size_t count_ = 0;
};

Expansion difference(double a, double b) {
  Expansion e;
  e.add(-b);
  e.add(a);
  return e;
}

// a * d - b * c
Expansion minorOf(const Expansion& a, const Expansion& b, const Expansion& c, const Expansion& d) {
  Expansion e;
  e.addProduct(a, d, 1.0);
  e.addProduct(b, c, -1.0);
  return e;
}

double slowVolume(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& p) {
  const Expansion ax = difference(a.x, p.x), ay = difference(a.y, p.y), az = difference(a.z, p.z);
  const Expansion bx = difference(b.x, p.x), by = difference(b.y, p.y), bz = difference(b.z, p.z);
  const Expansion cx = difference(c.x, p.x), cy = difference(c.y, p.y), cz = difference(c.z, p.z);
  Expansion sum;
  sum.addProduct(minorOf(bx, by, cx, cy), az, -1.0);
  sum.addProduct(minorOf(cx, cy, ax, ay), bz, -1.0);
  sum.addProduct(minorOf(ax, ay, bx, by), cz, -1.0);
  return sum.value();
}

// The error of a determinant of three rows is at most (7 + 56 e) e times the sum of its products' magnitudes,
// e = 2^-53; of one of two rows (3 + 16 e) e. A value 64 times above twice that is within 2 %.
constexpr double kVolumeFilter = 64.0 * 16.0 * 0x1p-53;
constexpr double kAreaFilter = 64.0 * 8.0 * 0x1p-53;

}  // namespace

double exactVolume(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& p) {
  const Vec3d u = a - p;
  const Vec3d v = b - p;
  const Vec3d w = c - p;
  const double vw = v.x * w.y, wv = v.y * w.x;
  const double wu = w.x * u.y, uw = w.y * u.x;
  const double uv = u.x * v.y, vu = u.y * v.x;
  const double sum = u.z * (vw - wv) + v.z * (wu - uw) + w.z * (uv - vu);
  const double size = (std::abs(vw) + std::abs(wv)) * std::abs(u.z) +
                      (std::abs(wu) + std::abs(uw)) * std::abs(v.z) +
                      (std::abs(uv) + std::abs(vu)) * std::abs(w.z);
  return std::abs(sum) > kVolumeFilter * size ? -sum : slowVolume(a, b, c, p);
}

double exactArea(double ax, double ay, double bx, double by, double px, double py) {
  const double left = (ax - px) * (by - py);
  const double right = (ay - py) * (bx - px);
  const double area = left - right;
  if (std::abs(area) > kAreaFilter * (std::abs(left) + std::abs(right))) {
    return area;
  }
  return minorOf(difference(ax, px), difference(ay, py), difference(bx, px), difference(by, py)).value();
}

}  // namespace sightline::layers
