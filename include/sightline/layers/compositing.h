#pragma once

// Turns an order with groups into image layers, and these into a program that composites the frame.
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

using LayerId = Id<struct LayerTag>;  // a layer of a FrameLayers, numbered from 0, group after group

// Some part of layer `front` occludes some part of layer `back`.
struct LayerOcclusion {
  LayerId front{}, back{};

  friend auto operator<=>(const LayerOcclusion&, const LayerOcclusion&) = default;
};

// The layers of a frame, each a set of parts to be drawn into one image. Plain data, as a recorded animation
// keeps it.
struct FrameLayers {
  std::vector<PartId> parts{};               // layer after layer; within a layer as in the order
  std::vector<std::uint32_t> first_part{};   // layers + 1 elements: where each layer begins in parts
  std::vector<std::uint32_t> first_layer{};  // groups + 1 elements: each group's first layer, front to back
  std::vector<LayerOcclusion> occlusions{};  // within groups; ascending; never both ways
  // The layer of all depth-buffered parts, whose surfaces hide what is behind them of the layers from
  // first_hidden on, up to itself. Not valid: there is none.
  LayerId depth_buffered{};
  LayerId first_hidden{0u};

  std::size_t layers() const { return first_part.empty() ? 0 : first_part.size() - 1; }
  std::size_t groups() const { return first_layer.empty() ? 0 : first_layer.size() - 1; }
  std::span<const PartId> partsOf(LayerId layer) const {
    const std::size_t i = layer.value;
    return std::span(parts).subspan(first_part[i], first_part[i + 1] - first_part[i]);
  }
};

// Merges parts that occlude each other mutually into one layer, and then layers that do, until no such pair
// is left (the paper's binary merged components). This is the finest division without such pairs. Layers of a
// group are ordered by their first parts. There are at most as many rounds as parts, each of which sorts the
// remaining arcs. merge() does not allocate after warm-up. For one thread at a time.
class LayerMerger {
 public:
  LayerMerger();
  ~LayerMerger();
  LayerMerger(LayerMerger&&) noexcept;
  LayerMerger& operator=(LayerMerger&&) noexcept;

  // order: with the arcs within groups (LayerSettings::arcs); those between groups are ignored. The result is
  // valid until the next call.
  const FrameLayers& merge(const LayerOrder& order);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// What a step of a program does. There are three registers, each of which holds an image (the paper's
// Figure 15). The operand is a layer's image or, without a layer, the register in brackets.
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
  LayerId layer{};  // the operand; not valid: the register. kLoad, kIn and kOut always have a layer

  friend bool operator==(const CompositingStep&, const CompositingStep&) = default;
};

// Numbers of steps by kind. kLoad and the two starts count as loads (from a layer) or moves (from a
// register).
struct CompositingCounts {
  std::uint64_t loads = 0, moves = 0;
  std::uint64_t ins = 0, outs = 0, adds = 0, overs = 0;

  std::uint64_t operations() const { return ins + outs + adds + overs; }  // as the paper counts
  friend bool operator==(const CompositingCounts&, const CompositingCounts&) = default;
};

// A program for the three registers. After the last step the frame's image is in Rover; without steps it is
// transparent.
struct CompositingProgram {
  std::vector<CompositingStep> steps{};
  std::vector<std::uint32_t> first_of{};  // groups + 1 elements: where each group's steps begin
  std::size_t layers = 0;                 // number of images that the program takes, one per layer

  std::span<const CompositingStep> group(std::size_t i) const {
    return std::span(steps).subspan(first_of[i], first_of[i + 1] - first_of[i]);
  }
};

// How a cycle of layers is composited. All forms agree on pixels whose layers have an order. Where a whole
// cycle covers a pixel (partly, at silhouettes), no form is right and they differ.
enum class CompositingForm : std::uint8_t {
  // The paper's expression 3: the sum of all layers, each "out" of all layers that occlude it.
  kSumOfOuts,
  // The paper's expression 4: (occluders of L atop L) over the image of all but L. L is the layer with the
  // fewest occluders in its cycle; ties go to the one that occludes most, then to the first. Its occluders
  // are composited by expression 3. The rest without L is divided into cycles again, and so on.
  kOverAtop,
  // Each cycle, also one of a rest, gets the form with fewer operations or, at a tie, fewer steps.
  kCheapest,
};

// Compiles layers to a program. A layer in no cycle takes one step. The time is linear except for cycles by
// expression 4, which take up to layers * occlusions of the cycle. compile() does not allocate after warm-up.
// Use by one thread at a time.
class CompositingCompiler {
 public:
  CompositingCompiler();
  ~CompositingCompiler();
  CompositingCompiler(CompositingCompiler&&) noexcept;
  CompositingCompiler& operator=(CompositingCompiler&&) noexcept;

  // left_out: layers to leave out (selective playback), in any order. The program treats them as transparent
  // and does not read their images. To leave out single parts of a layer, disable them in the sorter. The
  // result is valid until the next call.
  const CompositingProgram& compile(const FrameLayers& layers,
                                    CompositingForm form = CompositingForm::kCheapest,
                                    std::span<const LayerId> left_out = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Checks layers that do not come from LayerMerger; compile() requires it. Lists of firsts must begin at 0,
// ascend and end with the number of elements; occlusions must be between two layers of one group, ascending,
// and never both ways. Errors: the first violation.
Result<void> checkLayers(const FrameLayers& layers);

CompositingCounts countSteps(std::span<const CompositingStep> steps);

// Checks a program that was not just compiled. Its layers must be below `layers`, kLoad, kIn and kOut must
// have a layer, and every register must be started before it is used. Errors: the first step that violates
// this.
Result<void> checkProgram(std::span<const CompositingStep> steps, std::size_t layers);

// Returns a step as text: "load 3", "in 1", "out 3", "start sum", "add", "start image", "over 2". A number is
// a layer's; without a number the operand is the register.
std::string describe(const CompositingStep& step);
// Returns a program as text, one step per line.
std::string describe(const CompositingProgram& program);

}  // namespace sightline
