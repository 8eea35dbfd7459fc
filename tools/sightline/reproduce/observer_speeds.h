#pragma once

// How the time of culling depends on the observer's speed.

#include <cstdint>
#include <vector>

#include "tools/sightline/input/load.h"

namespace sightline::tool {

// At one speed; means of a frame.
struct SpeedResult {
  std::uint32_t speed = 1;  // times walking speed
  std::size_t frames = 0;
  double frustum_us = 0.0;      // view-frustum culling alone
  double coherent_us = 0.0;     // all of culling with what is kept from frame to frame
  double incoherent_us = 0.0;   // and with nothing kept
  double through_eye_us = 0.0;  // and with planes through the eye
  double reused = 0.0, unchanged = 0.0, rebuilt = 0.0;  // relations
};

// The same stretches of the path are walked at 1, 2, 4, ... 32 times 1.4 metres a second, 60 frames a second.
// stretch_frames: of each stretch, at the slowest. A speed is left out at which too few frames are left of
// it: all are, where the path does not move. setting: with kept relations.
std::vector<SpeedResult> measureSpeeds(const SceneAndWalk& input, CullingData& data, const Setting& setting,
                                       std::uint32_t stretch_frames);

}  // namespace sightline::tool
