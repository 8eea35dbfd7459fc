#pragma once

// Seeded families of boxes for tests of hierarchies.

#include <cmath>
#include <vector>

#include "sightline/math/box.h"
#include "tests/support/random_numbers.h"

namespace sightline::box_families {

using test::Random;

inline Vec3d pointWithin(const Box& box, Random& random) {
  Vec3d p;
  for (int axis = 0; axis < 3; ++axis) {
    p[axis] = random.in(box.min[axis], box.max[axis]);
  }
  return p;
}

enum class Family {
  kScattered,   // small boxes anywhere
  kLarge,       // most overlap many others
  kTouching,    // a regular grid, faces in common
  kFlat,        // without extent along some axes, points among them
  kNested,      // one centre
  kGeometric,   // each twice as far away as the one before
  kBeams,       // long and thin along an axis
  kIdentical,   // a few different boxes, many times each
  kOneLine,     // all centres on one line, all boxes through one plane
  kSeaOfSmall,  // one box around all others
};
inline constexpr Family kFamilies[] = {
    Family::kScattered, Family::kLarge, Family::kTouching,  Family::kFlat,    Family::kNested,
    Family::kGeometric, Family::kBeams, Family::kIdentical, Family::kOneLine, Family::kSeaOfSmall};

inline Box around(const Vec3d& middle, const Vec3d& half) {
  return {Vec3f(middle - half), Vec3f(middle + half)};
}

inline Box boxOf(Family family, std::size_t i, Random& random) {
  const double k = static_cast<double>(i);
  switch (family) {
    case Family::kScattered:
      return around(random.point(100.0), abs(random.point(1.0)));
    case Family::kLarge:
      return around(random.point(100.0), abs(random.point(80.0)));
    case Family::kTouching: {
      const Vec3d at(static_cast<double>(i % 8), static_cast<double>(i / 8 % 8), static_cast<double>(i / 64));
      return {Vec3f(at), Vec3f(at + Vec3d(1, 1, 1))};
    }
    case Family::kFlat: {
      Vec3d half = abs(random.point(3.0));
      for (int axis = 0; axis < 3; ++axis) {
        half[axis] = random.below(2) == 0 ? 0.0 : half[axis];
      }
      const Vec3d p = random.point(9.0);
      return around({std::floor(p.x), std::floor(p.y), std::floor(p.z)}, half);
    }
    case Family::kNested:
      return around({1, 2, 3}, Vec3d(1, 1, 1) * (1.0 + k));
    case Family::kGeometric:
      return around(Vec3d(1, 0, 0) * std::exp2(static_cast<double>(i % 60)), abs(random.point(0.4)));
    case Family::kBeams: {
      Vec3d half(0.1, 0.1, 0.1);
      half[static_cast<int>(random.below(3))] = 60.0;
      return around(random.point(50.0), half);
    }
    case Family::kIdentical:
      return around(Vec3d(static_cast<double>(i % 3), 0, 0), {1, 1, 1});
    case Family::kOneLine:
      return around({0, random.in(-1, 1), 0}, {2, 3, 2});
    case Family::kSeaOfSmall:
      return i == 0 ? around({}, {101, 101, 101}) : around(random.point(100.0), {0.2, 0.2, 0.2});
  }
  return {};
}

inline std::vector<Box> boxesOf(Family family, std::size_t count, Random& random) {
  std::vector<Box> boxes;
  for (std::size_t i = 0; i < count; ++i) {
    boxes.push_back(boxOf(family, i, random));
  }
  return boxes;
}

}  // namespace sightline::box_families
