#pragma once

// How a group of layers is composited: the tree of the paper's expressions, before it becomes steps.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sightline/layers/compositing.h"

namespace sightline::layers {

// Who occludes each layer of a frame, within its group.
struct LayerOccluders {
  std::vector<std::uint32_t> first;      // layers + 1
  std::vector<std::uint32_t> occluders;  // of layer i: from first[i] up to, not with, first[i + 1]; ascending

  void build(const FrameLayers& layers);
  std::size_t layers() const { return first.empty() ? 0 : first.size() - 1; }
  std::span<const std::uint32_t> of(std::uint32_t layer) const {
    return std::span(occluders).subspan(first[layer], first[layer + 1] - first[layer]);
  }
  bool occludes(std::uint32_t front, std::uint32_t back) const;
};

// Layers order[begin] up to, not with, order[end]: one that is in no circle, or all of a circle. Of a circle
// by over-atop, order[begin] is the layer that is taken out; the nodes of what is left follow, front to back.
struct ExpressionNode {
  static constexpr std::uint32_t kNone = 0xffffffffu;

  std::uint32_t begin = 0, end = 0;
  std::uint32_t parent = kNone;
  bool by_sum = false;       // by sum of outs: the nodes below it do not count
  std::uint64_t inner = 0;   // occlusions among its layers
  std::uint64_t around = 0;  // occluders of order[begin] in it
  std::uint64_t among = 0;   // occlusions among those
  // With more operations than this, it or a node above it is composited by sum of outs.
  std::uint64_t limit = 0;

  std::uint32_t size() const { return end - begin; }
};

class ExpressionPlanner {
 public:
  // occluders must stay until the next call. Layers: as many as it has.
  void beginFrame(const LayerOccluders& occluders);
  // group: layers of one group, ascending. What else there is of the group is left out.
  void plan(std::span<const std::uint32_t> group, CompositingForm form);

  // Of the last plan: parents before children, siblings front to back.
  std::span<const ExpressionNode> nodes() const { return nodes_; }
  std::span<const std::uint32_t> order() const { return order_; }
  bool contains(const ExpressionNode& node, std::uint32_t layer) const {
    return place_of_[layer] - node.begin < node.size();
  }

 private:
  struct Cost {
    std::uint64_t operations = 0, steps = 0;
    friend auto operator<=>(const Cost&, const Cost&) = default;
  };
  struct Visit {
    std::uint32_t layer = 0, next = 0;
  };

  void setOrder(std::span<const std::uint32_t> layers, std::uint32_t begin);
  void pushCircles(const ExpressionNode& range, std::uint32_t parent);
  void divide(ExpressionNode& node, std::uint32_t index, CompositingForm form);
  void findCirclesFrom(std::uint32_t root, const ExpressionNode& range);
  void enter(std::uint32_t layer);
  void leave(std::uint32_t layer);
  void count(ExpressionNode& node);
  void takeOneOut(ExpressionNode& node);
  void choose(CompositingForm form);

  const LayerOccluders* occluders_ = nullptr;
  std::vector<std::uint32_t> order_;
  std::vector<std::uint32_t> place_of_;  // by layer: in order_, or kNone
  std::vector<ExpressionNode> nodes_;
  std::vector<ExpressionNode> pending_;  // circles yet to become nodes, the next one last
  std::vector<std::uint32_t> occluded_;  // by layer: how many of the node it occludes
  std::vector<Cost> below_;              // by node: what its children cost
  // Tarjan's search, by layer; 0 is not seen, kNone is done.
  std::vector<std::uint32_t> number_, low_;
  std::vector<std::uint32_t> open_;
  std::vector<Visit> visits_;
  std::vector<std::uint32_t> found_, ends_;  // circles one after another, and where each ends
  std::uint32_t seen_ = 0;
};

}  // namespace sightline::layers
