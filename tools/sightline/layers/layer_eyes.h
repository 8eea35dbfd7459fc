#pragma once

// `layers --order-for` and `--stereo`: the eyes for which an order must hold, and the hulls of parts that
// move while the shutter is open.

#include <span>
#include <string>
#include <vector>

#include "sightline/layers/layer_sorter.h"
#include "tools/sightline/layers/layer_frames.h"
#include "tools/sightline/layers/layer_lens.h"

namespace sightline::tool {

struct LayerEyeOptions {
  std::string order_for;  // "eye" or "lens"; empty: "lens" if a picture is blurred by layers
  double stereo = 0.0;    // metres between two eyes, of which the view's is the middle; 0: one eye
};
void addLayerEyeOptions(CLI::App& command, LayerEyeOptions& options);
// "eye" or "lens".
std::string orderFor(const LayerEyeOptions& options, const LayerLensOptions& lens);

// The corners of a cube around the eye that holds the lens, however the camera is turned. None for a pinhole
// or an orthographic view.
std::vector<Vec3d> lensEyes(const View& view, double aperture);

// Sorts frames for the eyes that the options ask for.
class EyeSorter {
 public:
  EyeSorter(const LayerEyeOptions& options, const LayerLensOptions& lens, const LayerInput& input,
            const LayerSettings& settings);

  // Moves the parts to their places in a frame and finds its eyes.
  void place(std::uint32_t frame, const View& view);
  // Sorts the frame last placed, from its view; the result is valid until the next call.
  const LayerOrder& sort(const View& view) { return sorter_.update(view, more_eyes_); }
  // What sort() sorts with, and the eyes of the frame last placed besides the view's.
  LayerSorter& sorter() { return sorter_; }
  std::span<const Vec3d> moreEyes() const { return more_eyes_; }

 private:
  bool moves() const { return for_lens_ && motion_blur_ > 0.0; }
  void findEyes(std::uint32_t frame, const View& view);
  void sweep(std::uint32_t frame);

  const LayerInput& input_;
  LayerSettings settings_;
  bool for_lens_;
  double stereo_, aperture_, motion_blur_;
  LayerSorter sorter_;  // with motion blur, one for each frame
  std::vector<Mat4> poses_, other_poses_;
  std::vector<Vec3d> more_eyes_;
};

}  // namespace sightline::tool
