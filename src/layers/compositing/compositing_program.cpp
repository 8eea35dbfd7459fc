// Turns expressions into steps for three registers.
//
// Based on: Snyder, Lengyel. MSR-TR-97-11, section 8 and Figure 15. Expression 4 needs no more registers than
// expression 3. Let P be the occluders of L, and * the image of P by expression 3. Then
//   (* atop L) = (* in L) + (L out *) = sum over i of P of ((i out its occluders in P) in L) + (L out P):
// since "in" distributes over sums, and the transparency of P is the product of its layers' transparencies.
// Each term is a chain in R*, and their sum is in R+. R+ is composited over Rover at once, so nothing is kept
// for later.

#include <memory>
#include <span>
#include <vector>

#include "sightline/layers/compositing.h"
#include "src/layers/compositing/compositing_expression.h"

namespace sightline {

struct CompositingCompiler::Impl {
  layers::LayerOccluders occluders;
  layers::ExpressionPlanner planner;
  std::vector<std::uint8_t> is_left_out;  // one per layer
  std::vector<std::uint32_t> group;       // the layers of the current group that are not left out
  CompositingProgram program;
  bool has_image = false, has_sum = false;

  void emit(CompositingOp op, std::uint32_t layer) { program.steps.push_back({op, LayerId(layer)}); }
  void emitSumOfStar();
  void emitOver(LayerId layer);
  void emitSumOfOuts(const layers::ExpressionNode& node);
  void emitAtop(const layers::ExpressionNode& node);
  void emitGroup();
};

void CompositingCompiler::Impl::emitSumOfStar() {
  program.steps.push_back({has_sum ? CompositingOp::kAdd : CompositingOp::kStartSum, LayerId()});
  has_sum = true;
}

// layer: the operand; not valid: R+.
void CompositingCompiler::Impl::emitOver(LayerId layer) {
  program.steps.push_back({has_image ? CompositingOp::kOver : CompositingOp::kStartImage, layer});
  has_image = true;
  has_sum = false;
}

void CompositingCompiler::Impl::emitSumOfOuts(const layers::ExpressionNode& node) {
  for (const std::uint32_t layer : planner.order().subspan(node.begin, node.size())) {
    emit(CompositingOp::kLoad, layer);
    for (const std::uint32_t occluder : occluders.of(layer)) {
      if (planner.contains(node, occluder)) {
        emit(CompositingOp::kOut, occluder);
      }
    }
    emitSumOfStar();
  }
  emitOver(LayerId());
}

// Emits a layer and its occluders; the nodes of the rest follow.
void CompositingCompiler::Impl::emitAtop(const layers::ExpressionNode& node) {
  const std::uint32_t layer = planner.order()[node.begin];
  const auto isAround = [&](std::uint32_t other) {
    return planner.contains(node, other) && occluders.occludes(other, layer);
  };
  for (const std::uint32_t around : occluders.of(layer)) {
    if (!planner.contains(node, around)) {
      continue;
    }
    emit(CompositingOp::kLoad, around);
    for (const std::uint32_t occluder : occluders.of(around)) {
      if (isAround(occluder)) {
        emit(CompositingOp::kOut, occluder);
      }
    }
    emit(CompositingOp::kIn, layer);
    emitSumOfStar();
  }
  emit(CompositingOp::kLoad, layer);
  for (const std::uint32_t around : occluders.of(layer)) {
    if (planner.contains(node, around)) {
      emit(CompositingOp::kOut, around);
    }
  }
  emitSumOfStar();
  emitOver(LayerId());
}

void CompositingCompiler::Impl::emitGroup() {
  const auto nodes = planner.nodes();
  for (std::size_t i = 0; i < nodes.size();) {
    const layers::ExpressionNode& node = nodes[i++];
    if (node.size() == 1) {
      emitOver(LayerId(planner.order()[node.begin]));
    } else if (!node.by_sum) {
      emitAtop(node);
    } else {
      emitSumOfOuts(node);
      while (i < nodes.size() && nodes[i].begin < node.end) {
        ++i;
      }
    }
  }
}

CompositingCompiler::CompositingCompiler() : impl_(std::make_unique<Impl>()) {}
CompositingCompiler::~CompositingCompiler() = default;
CompositingCompiler::CompositingCompiler(CompositingCompiler&&) noexcept = default;
CompositingCompiler& CompositingCompiler::operator=(CompositingCompiler&&) noexcept = default;

const CompositingProgram& CompositingCompiler::compile(const FrameLayers& layers, CompositingForm form,
                                                       std::span<const LayerId> left_out) {
  Impl& c = *impl_;
  c.occluders.build(layers);
  c.planner.beginFrame(c.occluders);
  c.is_left_out.assign(layers.layers(), 0);
  for (const LayerId layer : left_out) {
    if (layer.value < c.is_left_out.size()) {
      c.is_left_out[layer.value] = 1;
    }
  }
  c.program.steps.clear();
  c.program.first_of.assign(1, 0u);
  c.program.layers = layers.layers();
  c.has_image = c.has_sum = false;
  for (std::size_t g = 0; g < layers.groups(); ++g) {
    c.group.clear();
    for (std::uint32_t i = layers.first_layer[g]; i < layers.first_layer[g + 1]; ++i) {
      if (c.is_left_out[i] == 0) {
        c.group.push_back(i);
      }
    }
    c.planner.plan(c.group, form);
    c.emitGroup();
    c.program.first_of.push_back(static_cast<std::uint32_t>(c.program.steps.size()));
  }
  return c.program;
}

}  // namespace sightline
