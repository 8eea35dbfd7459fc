#include "culling/wide_walk.h"

#include <algorithm>

namespace sightline::culling_detail {

using hierarchy_detail::WideNode;

namespace {
// Views that a box is kept without a question after it was found not hidden; up to three more.
constexpr std::uint8_t kLeastRest = 4;
}  // namespace

void WideWalk::run(const WalkMaps& maps, const WalkOptions& options, CullStats& stats,
                   std::vector<ObjectId>& out) {
  stack_.clear();
  if (!wide_.nodes.empty()) {
    // Of the root only the children are asked about; so it must be cheap by its own count.
    stack_.push_back({0, wide_.nodes[0].cost < options.min_node_cost});
  }
  while (!stack_.empty()) {
    const Entry entry = stack_.back();
    stack_.pop_back();
    visit(entry, maps, options, stats);
  }
  visible_.drainInto(out);
}

void WideWalk::visit(const Entry& entry, const WalkMaps& maps, const WalkOptions& options, CullStats& stats) {
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
    ask(maps, node, 0, children, false, options.temporal_coherence);
  } else {
    ask(maps, node, 0, asked, false, options.temporal_coherence);
    ask(maps, node, asked, node.node_count, true, false);
    ask(maps, node, node.node_count, children, !test_objects, options.temporal_coherence);
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

void WideWalk::ask(const WalkMaps& maps, const WideNode& node, std::uint32_t begin, std::uint32_t end,
                   bool view_only, bool skip_seen) {
  const std::span<const Box> boxes = std::span(wide_.boxes).subspan(node.first_child + begin, end - begin);
  const std::span<BoxAnswer> answers = std::span(answers_).subspan(begin, end - begin);
  if (boxes.empty()) {
    return;
  }
  if (view_only) {
    maps.map.classifyInView(boxes, answers);
    return;
  }
  BoxHints hints;
  const std::span<std::uint8_t> rest = std::span(rest_).subspan(node.first_child + begin, end - begin);
  if (skip_seen) {
    hints.seen = rest;
  }
  hints.plain_from = node.node_count > begin ? node.node_count - begin : 0;
  if (maps.fine != nullptr) {
    maps.window->tell(hints);
  }
  maps.map.classify(boxes, answers, hints);
  if (maps.window != nullptr) {
    askFineMap(maps, node, begin, end);
  }
  for (std::size_t i = 0; skip_seen && i < rest.size(); ++i) {
    const bool hidden = answers[i].visibility == Visibility::kHidden;
    // Of many that come into view together not all are asked about again in the same view.
    rest[i] = static_cast<std::uint8_t>(hidden ? 0u : rest[i] != 0 ? rest[i] - 1u : kLeastRest + (i & 3));
  }
}

// Of children that the map does not hide, those that the window's may.
void WideWalk::askFineMap(const WalkMaps& maps, const WideNode& node, std::uint32_t begin,
                          std::uint32_t end) {
  asked_again_.clear();
  asked_child_.clear();
  for (std::uint32_t i = begin; i < end; ++i) {
    const BoxAnswer& answer = answers_[i];
    if (answer.visibility == Visibility::kHidden || !answer.on_map) {
      continue;
    }
    if (i >= node.node_count) {
      maps.window->add(answer.x, answer.y, 1);
    }
    const bool rests = rest_[node.first_child + i] != 0;
    if (maps.fine != nullptr && !rests && maps.window->about(answer.x, answer.y)) {
      asked_again_.push_back(wide_.boxes[node.first_child + i]);
      asked_child_.push_back(i);
    }
  }
  if (asked_again_.empty()) {
    return;
  }
  second_answers_.resize(std::max(second_answers_.size(), asked_again_.size()));
  maps.fine->classify(asked_again_, std::span(second_answers_).first(asked_again_.size()), {.plain_from = 0});
  for (std::size_t i = 0; i < asked_again_.size(); ++i) {
    const BoxAnswer& second = second_answers_[i];
    if (second.within_view && second.visibility == Visibility::kHidden) {
      answers_[asked_child_[i]].visibility = Visibility::kHidden;
      const std::uint32_t child = asked_child_[i];
      if (child < node.node_count) {
        const WideNode& hidden = wide_.nodes[node.first_node + child];
        maps.window->add(answers_[child].x, answers_[child].y, hidden.object_end - hidden.first_object);
      }
    }
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
