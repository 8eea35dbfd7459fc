// Based on: Snyder, Lengyel. MSR-TR-97-11, section 8, expressions 3 and 4.
// Differs from the paper in: expression 4 uses expression 3 for the occluders of the layer that is taken out,
// so that it does not grow without bound; the rest is divided into cycles again, most of which are single
// layers.

#include "src/layers/compositing/compositing_expression.h"

#include <algorithm>

#include "src/base/rows.h"

namespace sightline::layers {
namespace {

constexpr std::uint32_t kNone = ExpressionNode::kNone;
constexpr std::uint64_t kNoLimit = ~std::uint64_t{0};

// Operations and steps of a cycle by sum of outs, including the final "over".
std::uint64_t sumOperations(const ExpressionNode& node) {
  return node.inner + (node.size() - 1) + 1;
}
std::uint64_t sumSteps(const ExpressionNode& node) {
  return node.size() + node.inner + node.size() + 1;
}
// Operations and steps of over-atop for the layer that is taken out, including the "over".
std::uint64_t atopOperations(const ExpressionNode& node) {
  return node.around + node.among + node.around + node.around + 1;
}
std::uint64_t atopSteps(const ExpressionNode& node) {
  const std::uint64_t terms = node.around + 1;
  return terms + node.around + node.among + node.around + terms + 1;
}

}  // namespace

void LayerOccluders::build(const FrameLayers& layers) {
  // Occlusions are sorted: each list ends up ascending.
  base::groupIntoRows(layers.layers(), first, occluders, [&](auto&& body) {
    for (const LayerOcclusion& o : layers.occlusions) {
      body(o.back.value, o.front.value);
    }
  });
}

bool LayerOccluders::occludes(std::uint32_t front, std::uint32_t back) const {
  const auto all = of(back);
  return std::binary_search(all.begin(), all.end(), front);
}

void ExpressionPlanner::beginFrame(const LayerOccluders& occluders) {
  occluders_ = &occluders;
  const std::size_t layers = occluders.layers();
  place_of_.assign(layers, kNone);
  components_.setNodeCount(layers);
  occluded_.resize(layers);
}

void ExpressionPlanner::plan(std::span<const std::uint32_t> group, CompositingForm form) {
  for (const std::uint32_t layer : order_) {
    if (layer < place_of_.size()) {
      place_of_[layer] = kNone;
    }
  }
  nodes_.clear();
  order_.resize(group.size());
  setOrder(group, 0);
  const auto size = static_cast<std::uint32_t>(group.size());
  pushCycles({.end = size, .limit = kNoLimit}, kNone);
  while (!pending_.empty()) {
    ExpressionNode node = pending_.back();
    pending_.pop_back();
    if (node.size() > 1) {
      count(node);
      if (form != CompositingForm::kSumOfOuts) {
        divide(node, static_cast<std::uint32_t>(nodes_.size()), form);
      }
    }
    nodes_.push_back(node);
  }
  choose(form);
}

// Takes one layer out and makes the rest pending, unless over-atop certainly takes more operations than
// allowed.
void ExpressionPlanner::divide(ExpressionNode& node, std::uint32_t index, CompositingForm form) {
  takeOneOut(node);
  ExpressionNode rest{.begin = node.begin + 1, .end = node.end, .limit = kNoLimit};
  if (form == CompositingForm::kCheapest) {
    const std::uint64_t limit = std::min(node.limit, sumOperations(node));
    const std::uint64_t own = atopOperations(node);
    if (own + rest.size() > limit) {
      node.by_sum = true;
      return;
    }
    rest.limit = limit - own;
  }
  pushCycles(rest, index);
}

void ExpressionPlanner::setOrder(std::span<const std::uint32_t> layers, std::uint32_t begin) {
  for (std::uint32_t i = 0; i < layers.size(); ++i) {
    order_[begin + i] = layers[i];
    place_of_[layers[i]] = begin + i;
  }
}

// Divides a range of the order into its strongly connected components, front to back, and makes them pending.
// Each gets the range's limit minus one operation for each layer of the others. The search goes from a layer
// to its occluders, so that a component is found after all components that occlude it.
void ExpressionPlanner::pushCycles(const ExpressionNode& range, std::uint32_t parent) {
  const std::uint32_t begin = range.begin;
  found_.clear();
  ends_.clear();
  components_.find(
      std::span(order_).subspan(begin, range.size()),
      [&](std::uint32_t layer) { return contains(range, layer); },
      [this](std::uint32_t layer) { return occluders_->of(layer); },
      [this](std::span<const std::uint32_t> cycle) {
        const auto first = found_.insert(found_.end(), cycle.begin(), cycle.end());
        std::sort(first, found_.end());
        ends_.push_back(static_cast<std::uint32_t>(found_.size()));
      });
  setOrder(found_, begin);
  for (std::size_t i = ends_.size(); i-- > 0;) {
    const std::uint32_t from = i == 0 ? 0 : ends_[i - 1];
    ExpressionNode node{.begin = begin + from, .end = begin + ends_[i], .parent = parent};
    const std::uint64_t others = range.size() - node.size();
    node.limit = range.limit == kNoLimit ? kNoLimit : range.limit - others;
    pending_.push_back(node);
  }
}

void ExpressionPlanner::count(ExpressionNode& node) {
  for (std::uint32_t i = node.begin; i < node.end; ++i) {
    occluded_[order_[i]] = 0;
  }
  for (std::uint32_t i = node.begin; i < node.end; ++i) {
    for (const std::uint32_t occluder : occluders_->of(order_[i])) {
      if (contains(node, occluder)) {
        ++occluded_[occluder];
        ++node.inner;
      }
    }
  }
}

// Moves the layer with the fewest occluders, which determine the cost of taking it out, to the node's begin.
// Ties go to the layer that occludes most, so that the fewest occlusions are left.
void ExpressionPlanner::takeOneOut(ExpressionNode& node) {
  std::uint32_t best = node.begin;
  std::uint64_t fewest = node.size();
  for (std::uint32_t i = node.begin; i < node.end; ++i) {
    const auto all = occluders_->of(order_[i]);
    const auto around = static_cast<std::uint64_t>(std::count_if(
        all.begin(), all.end(), [&](std::uint32_t occluder) { return contains(node, occluder); }));
    if (around < fewest || (around == fewest && occluded_[order_[i]] > occluded_[order_[best]])) {
      best = i;
      fewest = around;
    }
  }
  std::rotate(order_.begin() + node.begin, order_.begin() + best, order_.begin() + best + 1);
  for (std::uint32_t i = node.begin; i <= best; ++i) {
    place_of_[order_[i]] = i;
  }
  const std::uint32_t out = order_[node.begin];
  node.around = fewest;
  for (const std::uint32_t back : occluders_->of(out)) {
    for (const std::uint32_t front : occluders_->of(back)) {
      node.among += contains(node, back) && contains(node, front) && occluders_->occludes(front, out);
    }
  }
}

// Decides which cycles are composited by sum of outs. Goes backwards, so that children come before parents.
void ExpressionPlanner::choose(CompositingForm form) {
  below_.assign(nodes_.size(), {});
  for (std::size_t i = nodes_.size(); i-- > 0;) {
    ExpressionNode& node = nodes_[i];
    Cost cost{1, 1};  // one "over"
    if (node.size() > 1) {
      const Cost sum{sumOperations(node), sumSteps(node)};
      const Cost atop{atopOperations(node) + below_[i].operations, atopSteps(node) + below_[i].steps};
      node.by_sum = node.by_sum || form == CompositingForm::kSumOfOuts ||
                    (form == CompositingForm::kCheapest && !(atop < sum));
      cost = node.by_sum ? sum : atop;
      if (node.by_sum) {
        std::sort(order_.begin() + node.begin, order_.begin() + node.end);
      }
    }
    if (node.parent != kNone) {
      below_[node.parent].operations += cost.operations;
      below_[node.parent].steps += cost.steps;
    }
  }
}

}  // namespace sightline::layers
