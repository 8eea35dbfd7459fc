#pragma once

// What `layers` hands on, frame by frame: the sorted layers, to whatever makes pictures or drawings of them.

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sightline/layers/compositing.h"
#include "sightline/render/layer_renderer.h"
#include "tools/sightline/command_line/options.h"
#include "tools/sightline/input/layer_input.h"

namespace sightline::tool {

// Valid during the call that it is given to.
struct SortedFrame {
  std::uint32_t number = 0;  // in the walk
  const View& view;          // with square pixels
  const LayerOrder& order;
  const FrameLayers& layers;
  std::span<const Mat4> scene_from_stored;    // where the parts are, one a part; none: as stored
  std::function<void(double done)> progress;  // takes the share of the maker's work on this frame
};

// What a maker works with. Outlives it.
struct FrameMakerInput {
  const LayerInput& input;
  std::string scene_file;       // as the user named it
  std::uint32_t width, height;  // of the pictures, pixels
  std::uint32_t samples = 1;    // a side of each pixel: 1, 2 or 4
  bool tints = true;            // see LayerRendererOptions
  CompositingForm form = CompositingForm::kCheapest;
  bool several_frames = false;  // see frameFile
};

// Makes files of frames. A maker is created before anything is sorted, by
//   Result<std::unique_ptr<FrameMaker>> make...(const ...Options&, const FrameMakerInput&)
// which gives nullptr where the options ask for nothing, and checks all that can be checked then: options and
// OpenGL; output files were checked before (checkFiles).
class FrameMaker {
 public:
  virtual ~FrameMaker() = default;
  // Once a frame, ascending. The answer's keys are added to the frame's JSON: one key with an object.
  virtual Result<Json> make(const SortedFrame& frame) = 0;
  // After the last frame: a few lines on standard output, of what was measured.
  virtual void print() const = 0;
};

// Of the pictures that the input asks for.
Result<LayerRenderer> makeRenderer(const FrameMakerInput& input);

// Where a frame's file goes: `target` itself, or, of several frames, with the number before the extension:
// "dir/out_0012.png".
std::string frameFile(const std::string& target, std::uint32_t frame, bool several_frames);

}  // namespace sightline::tool
