#include <algorithm>
#include <cassert>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "sightline/layers/compositing.h"

namespace sightline {
namespace {

const char* nameOf(CompositingOp op) {
  switch (op) {
    case CompositingOp::kLoad:
      return "load";
    case CompositingOp::kIn:
      return "in";
    case CompositingOp::kOut:
      return "out";
    case CompositingOp::kStartSum:
      return "start sum";
    case CompositingOp::kAdd:
      return "add";
    case CompositingOp::kStartImage:
      return "start image";
    case CompositingOp::kOver:
      return "over";
  }
  return "?";
}

// The registers as bits, and those that a step reads as its operand, reads and changes, and writes.
enum Register : unsigned { kStar = 1, kSum = 2, kImage = 4 };
struct Use {
  unsigned operand = 0, reads = 0, writes = 0;
};

Use useOf(CompositingOp op) {
  switch (op) {
    case CompositingOp::kLoad:
      return {0, 0, kStar};
    case CompositingOp::kIn:
    case CompositingOp::kOut:
      return {0, kStar, kStar};
    case CompositingOp::kStartSum:
      return {kStar, 0, kSum};
    case CompositingOp::kAdd:
      return {kStar, kSum, kSum};
    case CompositingOp::kStartImage:
      return {kSum, 0, kImage};
    case CompositingOp::kOver:
      return {kSum, kImage, kImage};
  }
  return {};
}

// Returns what is wrong with a step, or null. started: the registers that hold an image.
const char* faultOf(const CompositingStep& step, std::size_t layers, unsigned started) {
  const Use use = useOf(step.op);
  if (use.writes == 0) {
    return "there is no such operation";
  }
  if (step.layer.valid() ? step.layer.value >= layers : use.operand == 0) {
    return "there is no such layer";
  }
  const unsigned needed = use.reads | (step.layer.valid() ? 0u : use.operand);
  return (needed & ~started) != 0 ? "a register is used before it holds anything" : nullptr;
}

}  // namespace

CompositingCounts countSteps(std::span<const CompositingStep> steps) {
  CompositingCounts counts;
  for (const CompositingStep& step : steps) {
    switch (step.op) {
      case CompositingOp::kLoad:
      case CompositingOp::kStartSum:
      case CompositingOp::kStartImage:
        ++(step.layer.valid() ? counts.loads : counts.moves);
        break;
      case CompositingOp::kIn:
        ++counts.ins;
        break;
      case CompositingOp::kOut:
        ++counts.outs;
        break;
      case CompositingOp::kAdd:
        ++counts.adds;
        break;
      case CompositingOp::kOver:
        ++counts.overs;
        break;
    }
  }
  return counts;
}

Status checkLayers(const FrameLayers& layers) {
  const auto lists = [](const std::vector<std::uint32_t>& first, std::size_t size) {
    return first.empty()
               ? size == 0
               : first.front() == 0 && first.back() == size && std::is_sorted(first.begin(), first.end());
  };
  if (!lists(layers.first_part, layers.parts.size()) || !lists(layers.first_layer, layers.layers())) {
    return Error{"layers of a frame: the lists of parts and layers do not fit together"};
  }
  const auto groupOf = [&](LayerId layer) {
    return std::upper_bound(layers.first_layer.begin(), layers.first_layer.end(), layer.value);
  };
  if (layers.depth_buffered.valid() && (layers.depth_buffered.value >= layers.layers() ||
                                        layers.first_hidden.value > layers.depth_buffered.value)) {
    return Error{"layers of a frame: the depth-buffered layer is none, or hides none before it"};
  }
  const std::vector<LayerOcclusion>& all = layers.occlusions;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto [front, back] = all[i];
    const bool sound = front.value < layers.layers() && back.value < layers.layers() && front != back &&
                       groupOf(front) == groupOf(back) && (i == 0 || all[i - 1] < all[i]) &&
                       !std::binary_search(all.begin(), all.end(), LayerOcclusion{back, front});
    if (!sound) {
      return Error{"layers of a frame: occlusion " + std::to_string(i) +
                   " is out of order, between groups, both ways, or of no layer"};
    }
  }
  return Success{};
}

Status checkProgram(std::span<const CompositingStep> steps, std::size_t layers) {
  unsigned started = 0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (const char* fault = faultOf(steps[i], layers, started)) {
      return Error{"compositing program, step " + std::to_string(i) + " (" + describe(steps[i]) +
                   "): " + fault};
    }
    started |= useOf(steps[i].op).writes;
  }
  if (!steps.empty() && (started & kImage) == 0) {
    return Error{"compositing program: no step starts the image"};
  }
  return Success{};
}

std::string describe(const CompositingStep& step) {
  std::string text = nameOf(step.op);
  if (step.layer.valid()) {
    text += ' ';
    text += std::to_string(step.layer.value);
  }
  return text;
}

std::string describe(const CompositingProgram& program) {
  std::string text;
  for (const CompositingStep& step : program.steps) {
    text += describe(step);
    text += '\n';
  }
  return text;
}

}  // namespace sightline
