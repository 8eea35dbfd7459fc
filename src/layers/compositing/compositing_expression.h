#pragma once

// The plan for compositing a group of layers: a tree of the paper's expressions, which is then turned into
// steps.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sightline/layers/compositing.h"
#include "src/base/strong_components.h"

namespace sightline::layers {

// The occluders of each layer of a frame within its group.
struct LayerOccluders {
  std::vector<std::uint32_t> first;      // layers + 1 elements
  std::vector<std::uint32_t> occluders;  // those of layer i are [first[i], first[i + 1]), ascending

  void build(const FrameLayers& layers);
  std::size_t layers() const { return first.empty() ? 0 : first.size() - 1; }
  std::span<const std::uint32_t> of(std::uint32_t layer) const {
    return std::span(occluders).subspan(first[layer], first[layer + 1] - first[layer]);
  }
  bool occludes(std::uint32_t front, std::uint32_t back) const;
};

// The layers order[begin] up to, but not including, order[end]: a strongly connected component, which is a
// single layer or a cycle. In a cycle by over-atop, order[begin] is the layer that is taken out, and the
// nodes of the rest follow, front to back.
struct ExpressionNode {
  static constexpr std::uint32_t kNone = 0xffffffffu;

  std::uint32_t begin = 0, end = 0;
  std::uint32_t parent = kNone;
  bool by_sum = false;       // true: composited by sum of outs, and the nodes below are not used
  std::uint64_t inner = 0;   // number of occlusions among its layers
  std::uint64_t around = 0;  // number of its layers that occlude order[begin]
  std::uint64_t among = 0;   // number of occlusions among those
  // If it takes more operations than this, it or a node above it is composited by sum of outs.
  std::uint64_t limit = 0;

  std::uint32_t size() const { return end - begin; }
};

class ExpressionPlanner {
 public:
  // Begins a frame with as many layers as `occluders` has, which must outlive the frame.
  void beginFrame(const LayerOccluders& occluders);
  // Plans a group. group: layers of one group, ascending; layers that are missing are left out.
  void plan(std::span<const std::uint32_t> group, CompositingForm form);

  // The nodes of the last plan, parents before children, siblings front to back.
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

  void setOrder(std::span<const std::uint32_t> layers, std::uint32_t begin);
  void pushCycles(const ExpressionNode& range, std::uint32_t parent);
  void divide(ExpressionNode& node, std::uint32_t index, CompositingForm form);
  void count(ExpressionNode& node);
  void takeOneOut(ExpressionNode& node);
  void choose(CompositingForm form);

  const LayerOccluders* occluders_ = nullptr;
  std::vector<std::uint32_t> order_;
  std::vector<std::uint32_t> place_of_;  // one per layer: its place in order_, or kNone
  std::vector<ExpressionNode> nodes_;
  std::vector<ExpressionNode> pending_;  // components yet to become nodes, the next one last
  std::vector<std::uint32_t> occluded_;  // one per layer: how many layers of the node it occludes
  std::vector<Cost> below_;              // one per node: the cost of its children
  base::StrongComponents components_;
  std::vector<std::uint32_t> found_, ends_;  // the components' layers, and where each component ends
};

}  // namespace sightline::layers
