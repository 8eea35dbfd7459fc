#pragma once

// Seeded views of every kind, and boxes before them.

#include <cmath>

#include "sightline/math/box.h"
#include "sightline/scene/camera.h"
#include "tests/support/random_numbers.h"

namespace sightline::test {

class ViewRandom : public Random {
 public:
  using Random::Random;
  // Returns a number between two limits; its logarithm is uniformly distributed.
  double sized(double low, double high) { return std::exp(in(std::log(low), std::log(high))); }
};

inline View randomView(ViewRandom& random) {
  View view;
  const double offsets[] = {0.0, 10.0, 1e4, 1e6};
  view.eye = random.point(1.0) * offsets[random.below(4)];
  setOrientation(view, random.below(4) == 0 ? Vec3d(0, 0, -1) : random.point(1.0), {0, 1, 0});
  view.orthographic = random.below(4) == 0;
  view.tan_half_fovy = random.sized(0.01, 5.0);
  view.ortho_height = random.sized(0.5, 500.0);
  view.aspect = random.sized(0.3, 3.0);
  view.z_near = random.sized(1e-3, 1.0);
  view.z_far = random.sized(50.0, 1e5);
  if (random.below(2) == 0) {
    const double reach = random.sized(1e-6, 20.0);
    view.shift_x = random.in(-reach, reach);
    view.shift_y = random.in(-reach, reach);
  }
  return view;
}

// Returns a box, in most cases in view; some are points, flat, huge, around the eye or across the near plane.
inline Box randomBox(ViewRandom& random, const View& view) {
  const double depth =
      random.below(5) == 0 ? random.in(-1.0, 3.0) * view.z_near : random.sized(view.z_near, 300.0);
  const double reach = view.orthographic ? view.ortho_height : view.tan_half_fovy * std::abs(depth);
  const Vec3d middle = view.eye + view.forward * depth +
                       view.right * (reach * (random.in(-1.0, 1.0) + view.shift_x)) +
                       view.up * (reach * (random.in(-1.0, 1.0) + view.shift_y));
  Vec3d half = abs(random.point(1.0)) * (std::abs(depth) * random.sized(1e-5, 3.0));
  for (int axis = 0; axis < 3; ++axis) {
    const std::uint64_t kind = random.below(12);
    half[axis] = kind == 0 ? 0.0 : kind == 1 ? half[axis] * 1e3 : half[axis];
  }
  return {Vec3f(middle - half), Vec3f(middle + half)};
}

}  // namespace sightline::test
