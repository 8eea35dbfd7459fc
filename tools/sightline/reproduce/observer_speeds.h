#pragma once

// Measures how the time of culling depends on the observer's speed.

#include <cstdint>
#include <vector>

#include "tools/sightline/input/load.h"

namespace sightline::tool {

// The results at one speed; all numbers but speed and frames are means over the frames.
struct SpeedResult {
  std::uint32_t speed = 1;  // times walking speed
  std::size_t frames = 0;
  double frustum_us = 0.0;      // view-frustum culling alone
  double coherent_us = 0.0;     // all of culling, with relations kept from frame to frame
  double incoherent_us = 0.0;   // all of culling, with nothing kept
  double through_eye_us = 0.0;  // all of culling, with planes through the eye
  double reused = 0.0, unchanged = 0.0, rebuilt = 0.0;  // relations
};

// Moves along the same stretches of the camera path at 1, 2, 4, ... 32 times 1.4 metres a second with 60
// frames a second. Each stretch has stretch_frames frames at the slowest speed. A speed with too few frames
// is left out; if the camera does not move, all are. Precondition: setting keeps relations.
std::vector<SpeedResult> measureSpeeds(const SceneAndWalk& input, CullingData& data, const Setting& setting,
                                       std::uint32_t stretch_frames);

}  // namespace sightline::tool
