#pragma once

// From an order with groups to image layers and a program that composites their images into the frame's.
//
//   LayerSorter -> LayerOrder -> LayerMerger -> FrameLayers -> CompositingCompiler -> CompositingProgram
//
// Based on: Snyder, Lengyel. MSR-TR-97-11, 1997, section 8. Porter, Duff. Compositing Digital Images. 1984.
// The operators, of premultiplied images: A in B = A * alpha(B); A out B = A * (1 - alpha(B));
// A over B = A + B out A; A atop B = A in B + B out A.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sightline/base/ids.h"
#include "sightline/base/result.h"
#include "sightline/layers/layer_sorter.h"

namespace sightline {

using LayerId = Id<struct LayerTag>;  // layer of a FrameLayers, from 0, group after group

// Parts of layer `front` occlude parts of layer `back`.
struct LayerOcclusion {
  LayerId front{}, back{};

  friend auto operator<=>(const LayerOcclusion&, const LayerOcclusion&) = default;
};

// What to draw into one image each. Plain data: what a recorded animation keeps of a frame.
struct FrameLayers {
  std::vector<PartId> parts{};               // layer after layer; in a layer as in the order
  std::vector<std::uint32_t> first_part{};   // layers + 1: where each layer's begin in parts
  std::vector<std::uint32_t> first_layer{};  // groups + 1: the first layer of each; groups front to back
  std::vector<LayerOcclusion> occlusions{};  // between layers of one group; ascending; never both ways

  std::size_t layers() const { return first_part.empty() ? 0 : first_part.size() - 1; }
  std::size_t groups() const { return first_layer.empty() ? 0 : first_layer.size() - 1; }
  std::span<const PartId> partsOf(LayerId layer) const {
    const std::size_t i = layer.value;
    return std::span(parts).subspan(first_part[i], first_part[i + 1] - first_part[i]);
  }
};

// Puts parts that occlude each other into one layer; then layers that do, until no two are left that do (the
// paper's binary merged components). No finer division is free of such pairs. Layers of a group are ordered
// by their first parts. Each round of merging sorts the arcs that are left; there are at most as many as
// parts. No allocation after warm-up. For one thread at a time.
class LayerMerger {
 public:
  LayerMerger();
  ~LayerMerger();
  LayerMerger(LayerMerger&&) noexcept;
  LayerMerger& operator=(LayerMerger&&) noexcept;

  // Arcs between groups, if there are any, do not matter. The answer is valid until the next call.
  const FrameLayers& merge(const LayerOrder& order);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// What a step of a program does. There are three registers (the paper's Figure 15), each holding an image;
// the operand is a layer's image, or else the register named in brackets.
enum class CompositingOp : std::uint8_t {
  kLoad,        // R* = layer
  kIn,          // R* = R* in layer
  kOut,         // R* = R* out layer
  kStartSum,    // R+ = layer [R*]
  kAdd,         // R+ = R+ + layer [R*]
  kStartImage,  // Rover = layer [R+]
  kOver,        // Rover = Rover over layer [R+]
};

struct CompositingStep {
  CompositingOp op = CompositingOp::kLoad;
  LayerId layer{};  // not valid: the register. kLoad, kIn and kOut always have one

  friend bool operator==(const CompositingStep&, const CompositingStep&) = default;
};

// Steps by kind. `loads` and `moves` are what kLoad and the two starts are, from a layer and from a register.
struct CompositingCounts {
  std::uint64_t loads = 0, moves = 0;
  std::uint64_t ins = 0, outs = 0, adds = 0, overs = 0;

  std::uint64_t operations() const { return ins + outs + adds + overs; }  // as the paper counts
  friend bool operator==(const CompositingCounts&, const CompositingCounts&) = default;
};

// The image is in Rover after the last step. Without steps it is transparent.
struct CompositingProgram {
  std::vector<CompositingStep> steps{};
  std::vector<std::uint32_t> first_of{};  // groups + 1: where each group's steps begin
  std::size_t layers = 0;                 // of the FrameLayers: so many images it takes

  std::span<const CompositingStep> group(std::size_t i) const {
    return std::span(steps).subspan(first_of[i], first_of[i + 1] - first_of[i]);
  }
};

// How layers that occlude each other in a circle are composited. Wherever the layers that cover a pixel have
// an order, all give the same; where a whole circle covers one pixel (partly, at silhouettes), none is right
// and they differ.
enum class CompositingForm : std::uint8_t {
  // The paper's expression 3: the sum of all layers, each "out" of all that occlude it.
  kSumOfOuts,
  // The paper's expression 4: (occluders of L atop L) over the image of all but L. L is the layer with the
  // fewest occluders in its circle; of those the one that occludes most; of those the first. Its occluders
  // are composited by expression 3; what is left without L is divided into circles again, and so on.
  kOverAtop,
  // In each circle, also of those that are left, whichever takes fewer operations; if both take as many,
  // fewer steps.
  kCheapest,
};

// A layer in no circle takes one step. The time is linear, but for circles by expression 4: there up to
// layers * occlusions of the circle. No allocation after warm-up. For one thread at a time.
class CompositingCompiler {
 public:
  CompositingCompiler();
  ~CompositingCompiler();
  CompositingCompiler(CompositingCompiler&&) noexcept;
  CompositingCompiler& operator=(CompositingCompiler&&) noexcept;

  // left_out: layers to compile the program without (selective playback), in any order. It then composites
  // what all the others show, as if these were transparent, and does not touch their images. (To leave out
  // single parts of a layer, disable them in the sorter.) The answer is valid until the next call.
  const CompositingProgram& compile(const FrameLayers& layers,
                                    CompositingForm form = CompositingForm::kCheapest,
                                    std::span<const LayerId> left_out = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// What layers that LayerMerger did not just make must fulfil before they are compiled: lists that begin at 0,
// ascend and end with what they list; occlusions between two layers of one group, ascending, never both ways.
// Errors: what is not so.
Status checkLayers(const FrameLayers& layers);

CompositingCounts countSteps(std::span<const CompositingStep> steps);

// What a program that was not just compiled must fulfil: its layers are below `layers`, kLoad, kIn and kOut
// have one, and every register is started before it is used. Errors: the first step that does not.
Status checkProgram(std::span<const CompositingStep> steps, std::size_t layers);

// "load 3", "in 1", "out 3", "start sum", "add", "start image", "over 2"; a number is a layer's, no number
// means the register.
std::string describe(const CompositingStep& step);
// One step a line.
std::string describe(const CompositingProgram& program);

}  // namespace sightline
