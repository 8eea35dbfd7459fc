#pragma once

#include "sightline/culling/culler.h"
#include "src/base/stopwatch.h"

namespace sightline::tool {

// A culler along a camera path, with the time of its last frame measured from outside.
struct CullRun {
  Culler culler;
  double cull_us = 0.0;

  void cull(const View& view) {
    base::Stopwatch watch;
    culler.cull(view);
    cull_us = watch.lap();
  }
};

}  // namespace sightline::tool
