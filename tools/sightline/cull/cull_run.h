#pragma once

#include <chrono>

#include "sightline/culling/culler.h"

namespace sightline::tool {

// A culler along a camera path, with the time of its last frame measured from outside.
struct CullRun {
  Culler culler;
  double cull_us = 0.0;

  void cull(const View& view) {
    const auto start = std::chrono::steady_clock::now();
    culler.cull(view);
    cull_us = std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
  }
};

}  // namespace sightline::tool
