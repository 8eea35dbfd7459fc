#pragma once

// A hash of numbers, one after the other.

#include <bit>
#include <cstdint>

#include "sightline/math/box.h"
#include "src/pvs/format/checksum.h"

namespace sightline::pvs {

class NumberHash {
 public:
  void add(std::uint64_t number) { hash_.addValue(number); }
  // 0 and -0 are the same.
  void add(double number) { hash_.addValue(std::bit_cast<std::uint64_t>(number + 0.0)); }
  void add(const Vec3d& v) {
    add(v.x);
    add(v.y);
    add(v.z);
  }
  void add(const Box& box) {
    add(Vec3d(box.min));
    add(Vec3d(box.max));
  }
  std::uint64_t value() const { return hash_.value(); }

 private:
  Checksum hash_;
};

}  // namespace sightline::pvs
