#pragma once

// `layers --depth-of-field` and `--motion-blur`: blurred pictures of sorted frames, compared with the
// accumulation of whole pictures.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tools/sightline/layers/layer_frames.h"

namespace sightline::tool {

struct LayerLensOptions {
  std::string depth_of_field;  // empty: none
  double focus = 0.0, aperture = 0.0;
  double motion_blur = 0.0;             // share of a frame's time for which the shutter is open; 0: none
  std::uint32_t passes = 21;            // pictures that an accumulation takes
  std::uint32_t reference_passes = 64;  // pictures that the reference of --compare takes
  std::vector<std::string> blur_layer;  // PART=even|depth|accumulate
  std::string blurred, compare;         // files; empty: none

  bool operator==(const LayerLensOptions&) const = default;
};
// The frame whose difference from this one is the motion of motion blur: the next, or of the last frame the
// one before. None if there is only one frame.
std::optional<std::uint32_t> motionFrame(const Walk& walk, std::uint32_t frame);
void addLayerLensOptions(CLI::App& command, LayerLensOptions& options);

Result<std::unique_ptr<FrameMaker>> makeLayerLens(const LayerLensOptions& options,
                                                  const FrameMakerInput& input);

}  // namespace sightline::tool
