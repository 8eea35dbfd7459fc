#pragma once

// The interface by which `layers` passes each sorted frame to what makes pictures or drawings of it.

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

// A sorted frame; valid during the call of FrameMaker::make().
struct SortedFrame {
  std::uint32_t number = 0;  // number of the frame on the camera path
  const View& view;          // with square pixels
  const LayerOrder& order;
  const FrameLayers& layers;
  std::span<const Mat4> scene_from_stored;    // one transform per part; empty: as stored
  std::span<const ObjectPiece> pieces;        // of divided parts, ascending; other parts are whole
  std::function<void(double done)> progress;  // called with the share of the maker's work done, 0 to 1

  // The part of the scene that a number in the order stands for: of a piece, the part that it is of.
  PartId wholeOf(PartId part_or_piece) const;
};

// The input of a maker, which must outlive it.
struct FrameMakerInput {
  const LayerInput& input;
  std::string scene_file;       // as the user named it
  std::uint32_t width, height;  // size of the pictures in pixels
  std::uint32_t samples = 1;    // samples along each side of a pixel: 1, 2 or 4
  bool tints = true;            // see LayerRendererOptions
  CompositingForm form = CompositingForm::kCheapest;
  bool seen_first = false;      // drawings are ordered by what their outlines show
  bool several_frames = false;  // see frameFile
};

// Makes files of frames. A maker is created before the first frame is sorted, by a function
//   Result<std::unique_ptr<FrameMaker>> make...(const ...Options&, const FrameMakerInput&)
// which returns nullptr if the options ask for nothing. It checks the options and OpenGL; the output files
// have been checked before (checkFiles).
class FrameMaker {
 public:
  virtual ~FrameMaker() = default;
  // Called once per frame, ascending. Returns an object with one key, which is added to the frame's JSON.
  virtual Result<Json> make(const SortedFrame& frame) = 0;
  // Called after the last frame; prints a few lines of measurements on standard output.
  virtual void print() const = 0;
};

// Returns a renderer for pictures of the size that the input asks for.
Result<LayerRenderer> makeRenderer(const FrameMakerInput& input);

// Returns the name of a frame's file: `target`, or for several frames `target` with the number before the
// extension, as in "dir/out_0012.png".
std::string frameFile(const std::string& target, std::uint32_t frame, bool several_frames);

}  // namespace sightline::tool
