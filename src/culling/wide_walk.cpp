#include "culling/wide_walk.h"

#include <algorithm>

namespace sightline::culling_detail {

using hierarchy_detail::WideNode;

namespace {
// Views that a box is kept without a question after it was found not hidden; up to three more.
constexpr std::uint8_t kLeastRest = 2;
}  // namespace

void WideWalk::run(const DepthPyramid& pyramid, const WalkOptions& options, CullStats& stats,
                   std::vector<ObjectId>& out) {
  stack_.clear();
  if (!wide_.nodes.empty()) {
    // Of the root only the children are asked about; so it must be cheap by its own count.
    stack_.push_back({0, wide_.nodes[0].cost < options.min_node_cost});
  }
  while (!stack_.empty()) {
    const Entry entry = stack_.back();
    stack_.pop_back();
    visit(entry, pyramid, options, stats);
  }
  visible_.drainInto(out);
}

void WideWalk::visit(const Entry& entry, const DepthPyramid& pyramid, const WalkOptions& options,
                     CullStats& stats) {
  const WideNode& node = wide_.nodes[entry.node];
  const std::uint32_t children = node.child_end - node.first_child;
  // Children that are nodes lie in the order of their cost: first those to be asked about.
  std::uint32_t asked = entry.surely_visible ? 0 : node.node_count;
  while (asked > 0 && wide_.nodes[node.first_node + asked - 1].cost < options.min_node_cost) {
    --asked;
  }
  const bool test_objects = !entry.surely_visible && options.test_objects;
  answers_.resize(std::max<std::size_t>(answers_.size(), children));
  if (asked == node.node_count && test_objects) {
    ask(pyramid, node, 0, children, false, options.temporal_coherence);
  } else {
    ask(pyramid, node, 0, asked, false, options.temporal_coherence);
    ask(pyramid, node, asked, node.node_count, true, false);
    ask(pyramid, node, node.node_count, children, !test_objects, options.temporal_coherence);
  }
  stats.nodes_visited += node.node_count;
  stats.nodes_tested += asked;
  stats.objects_tested += test_objects ? children - node.node_count : 0;

  for (std::uint32_t i = 0; i < node.node_count; ++i) {
    keepNode(node.first_node + i, answers_[i], i >= asked);
  }
  for (std::uint32_t i = node.node_count; i < children; ++i) {
    if (answers_[i].visibility != Visibility::kHidden) {
      visible_.insert(wide_.object[node.first_child + i]);
    }
  }
}

void WideWalk::ask(const DepthPyramid& pyramid, const WideNode& node, std::uint32_t begin, std::uint32_t end,
                   bool view_only, bool skip_seen) {
  const std::span<const Box> boxes = std::span(wide_.boxes).subspan(node.first_child + begin, end - begin);
  const std::span<BoxAnswer> answers = std::span(answers_).subspan(begin, end - begin);
  if (boxes.empty()) {
    return;
  }
  if (view_only) {
    pyramid.classifyInView(boxes, answers);
    return;
  }
  BoxHints hints;
  const std::span<std::uint8_t> rest = std::span(rest_).subspan(node.first_child + begin, end - begin);
  if (skip_seen) {
    hints.seen = rest;
  }
  hints.plain_from = node.node_count > begin ? node.node_count - begin : 0;
  pyramid.classify(boxes, answers, hints);
  for (std::size_t i = 0; skip_seen && i < rest.size(); ++i) {
    const bool hidden = answers[i].visibility == Visibility::kHidden;
    // Of many that come into view together not all are asked about again in the same view.
    rest[i] = static_cast<std::uint8_t>(hidden ? 0u : rest[i] != 0 ? rest[i] - 1u : kLeastRest + (i & 3));
  }
}

void WideWalk::keepNode(std::uint32_t node, const BoxAnswer& answer, bool view_only) {
  if (answer.visibility == Visibility::kHidden) {
    return;
  }
  const bool surely_visible = view_only || answer.visibility == Visibility::kVisible;
  if (!surely_visible || !answer.within_view) {
    stack_.push_back({node, surely_visible});
    return;
  }
  const WideNode& whole = wide_.nodes[node];
  for (std::uint32_t i = whole.first_object; i < whole.object_end; ++i) {
    visible_.insert(hierarchy_.objects[i]);
  }
}

}  // namespace sightline::culling_detail
