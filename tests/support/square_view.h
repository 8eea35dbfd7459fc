#pragma once

#include "sightline/scene/camera.h"

namespace sightline::test {

// A view from the origin along -z, 90 degrees wide in both directions.
inline View squareView(double near, double far) {
  View view;
  setOrientation(view, {0, 0, -1}, {0, 1, 0});
  view.tan_half_fovy = 1.0;
  view.aspect = 1.0;
  view.z_near = near;
  view.z_far = far;
  return view;
}

}  // namespace sightline::test
