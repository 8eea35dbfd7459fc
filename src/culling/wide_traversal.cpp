#include "src/culling/wide_traversal.h"

#include <algorithm>

namespace sightline::culling {

using hierarchy::kWideChildren;
using hierarchy::WideNode;

namespace {
// Views that a box is kept without a question after it was found not hidden; up to three more.
constexpr std::uint8_t kMinRest = 6;
}  // namespace

class WideTraversal::Walker {
 public:
  Walker(WideTraversal& walk, const TraversalMaps& maps, const TraversalOptions& options, Found& found)
      : hierarchy_(walk.hierarchy_),
        wide_(walk.wide_),
        rest_(walk.rest_),
        in_set_(walk.in_set_),
        child_marks_(walk.child_marks_ ? walk.child_marks_->marks() : std::span<const std::uint8_t>()),
        maps_(maps),
        options_(options),
        found_(found) {}

  // Nodes that are to be visited next go to found.stack.
  void visit(const Entry& entry);

 private:
  // Of children `begin` to before `end` of the node: how many are in the set.
  std::uint32_t members(const WideNode& node, std::uint32_t begin, std::uint32_t end) const;
  // Their answers: past the occluders, or for the view's volume alone. What is not in the set is hidden.
  void ask(const WideNode& node, std::uint32_t begin, std::uint32_t end, bool view_only);
  void askMembers(const WideNode& node, std::uint32_t begin, std::uint32_t end, bool view_only);
  void askMap(std::span<const Box> boxes, std::span<const std::uint8_t> rest, std::size_t plain_from,
              bool view_only, std::span<BoxAnswer> answers);
  void askFineMap(const WideNode& node, std::uint32_t begin, std::uint32_t end);
  void keepNode(std::uint32_t node, const BoxAnswer& answer, bool view_only);

  const Hierarchy& hierarchy_;
  const hierarchy::WideHierarchy& wide_;
  std::span<std::uint8_t> rest_;
  ObjectSet in_set_;
  std::span<const std::uint8_t> child_marks_;  // unless everything is in the set
  const TraversalMaps& maps_;
  const TraversalOptions& options_;
  Found& found_;
};

void WideTraversal::run(const TraversalMaps& maps, const TraversalOptions& options, CullStats& stats,
                        std::vector<ObjectId>& out, const ParallelFor& parallel_for) {
  entries_.clear();
  if (!wide_.nodes.empty()) {
    // Of the root only the children are asked about; so it must be cheap by its own count.
    entries_.push_back({0, wide_.nodes[0].cost < options.min_node_cost});
  }
  // Level by level until there is enough to share.
  Found& first = found_[0];
  std::size_t next = 0;
  while (next < entries_.size() && entries_.size() - next < kMaxRanges - kWideChildren) {
    Walker(*this, maps, options, first).visit(entries_[next++]);
    entries_.insert(entries_.end(), first.stack.begin(), first.stack.end());
    first.stack.clear();
  }
  take(first, maps, stats);
  entries_.erase(entries_.begin(), entries_.begin() + static_cast<std::ptrdiff_t>(next));
  const auto count = static_cast<std::uint32_t>(entries_.size());
  // One reference is captured: more would be put on the heap.
  const auto walk_range = [&](std::uint32_t begin, std::uint32_t end) {
    Found& found = found_[begin];
    Walker walker(*this, maps, options, found);
    for (std::uint32_t i = begin; i < end; ++i) {
      found.stack.push_back(entries_[i]);
      while (!found.stack.empty()) {
        const Entry entry = found.stack.back();
        found.stack.pop_back();
        walker.visit(entry);
      }
    }
  };
  parallel_for(count, [&walk_range](std::uint32_t begin, std::uint32_t end) { walk_range(begin, end); });
  for (std::uint32_t i = 0; i < count; ++i) {
    take(found_[i], maps, stats);
  }
  visible_.drainInto(out);
}

TreeMarks WideTraversal::marksOfChildren() const {
  std::vector<std::uint32_t> parents(wide_.boxes.size(), TreeMarks::kTop);
  std::vector<TreeMarks::Place> places;
  for (const WideNode& node : wide_.nodes) {
    for (std::uint32_t child = node.first_child; child < node.child_end; ++child) {
      const std::uint32_t i = child - node.first_child;
      if (i >= node.node_count) {
        places.push_back({wide_.object[child], child});
        continue;
      }
      const WideNode& below = wide_.nodes[node.first_node + i];
      std::fill(parents.begin() + below.first_child, parents.begin() + below.child_end, child);
    }
  }
  return {std::move(parents), places, object_count_};
}

void WideTraversal::restrictTo(const ObjectSet& objects) {
  in_set_ = objects;
  if (objects.everything()) {
    return;
  }
  if (!child_marks_) {
    child_marks_.emplace(marksOfChildren());
  }
  child_marks_->mark(objects.list);
  // What was found of a child before it left the set says nothing of when it comes back.
  for (std::size_t child = 0; child < rest_.size(); ++child) {
    rest_[child] &= child_marks_->marks()[child];
  }
}

void WideTraversal::take(Found& found, const TraversalMaps& maps, CullStats& stats) {
  for (const ObjectId object : found.kept) {
    visible_.insert(object);
  }
  for (const Shown& shown : found.shown) {
    maps.window->add(shown.x, shown.y, shown.objects);
  }
  stats.nodes_visited += found.nodes_visited;
  stats.nodes_tested += found.nodes_tested;
  stats.objects_tested += found.objects_tested;
  found.kept.clear();
  found.shown.clear();
  found.nodes_visited = found.nodes_tested = found.objects_tested = 0;
}

void WideTraversal::Walker::visit(const Entry& entry) {
  const WideNode& node = wide_.nodes[entry.node];
  const std::uint32_t children = node.child_end - node.first_child;
  // Children that are nodes lie in the order of their cost: first those to be asked about.
  std::uint32_t asked = entry.surely_visible ? 0 : node.node_count;
  while (asked > 0 && wide_.nodes[node.first_node + asked - 1].cost < options_.min_node_cost) {
    --asked;
  }
  const bool test_objects = !entry.surely_visible && options_.test_objects;
  found_.answers.resize(std::max<std::size_t>(found_.answers.size(), children));
  if (asked == node.node_count && test_objects) {
    ask(node, 0, children, false);
  } else {
    ask(node, 0, asked, false);
    ask(node, asked, node.node_count, true);
    ask(node, node.node_count, children, !test_objects);
  }
  found_.nodes_visited += members(node, 0, node.node_count);
  found_.nodes_tested += members(node, 0, asked);
  found_.objects_tested += test_objects ? members(node, node.node_count, children) : 0;

  for (std::uint32_t i = 0; i < node.node_count; ++i) {
    keepNode(node.first_node + i, found_.answers[i], i >= asked);
  }
  for (std::uint32_t i = node.node_count; i < children; ++i) {
    if (found_.answers[i].visibility != Visibility::kHidden) {
      found_.kept.push_back(wide_.object[node.first_child + i]);
    }
  }
}

void WideTraversal::Walker::ask(const WideNode& node, std::uint32_t begin, std::uint32_t end,
                                bool view_only) {
  if (begin == end) {
    return;
  }
  const std::span<BoxAnswer> answers = std::span(found_.answers).subspan(begin, end - begin);
  const std::span<std::uint8_t> rest = rest_.subspan(node.first_child + begin, end - begin);
  if (members(node, begin, end) == end - begin) {
    const std::span<const Box> boxes = std::span(wide_.boxes).subspan(node.first_child + begin, end - begin);
    askMap(boxes, rest, node.node_count > begin ? node.node_count - begin : 0, view_only, answers);
  } else {
    askMembers(node, begin, end, view_only);
  }
  if (view_only) {
    return;
  }
  if (maps_.window != nullptr) {
    askFineMap(node, begin, end);
  }
  for (std::size_t i = 0; options_.temporal_coherence && i < rest.size(); ++i) {
    const bool hidden = answers[i].visibility == Visibility::kHidden;
    // Of many that come into view together not all are asked about again in the same view.
    rest[i] = static_cast<std::uint8_t>(hidden ? 0u : rest[i] != 0 ? rest[i] - 1u : kMinRest + (i & 3));
  }
}

void WideTraversal::Walker::askMap(std::span<const Box> boxes, std::span<const std::uint8_t> rest,
                                   std::size_t plain_from, bool view_only, std::span<BoxAnswer> answers) {
  if (view_only) {
    maps_.map.classifyInView(boxes, answers);
    return;
  }
  BoxHints hints;
  if (options_.temporal_coherence) {
    hints.seen = rest;
  }
  hints.plain_from = plain_from;
  if (maps_.fine != nullptr) {
    maps_.window->tell(hints);
  }
  maps_.map.classify(boxes, answers, hints);
}

std::uint32_t WideTraversal::Walker::members(const WideNode& node, std::uint32_t begin,
                                             std::uint32_t end) const {
  if (in_set_.everything()) {
    return end - begin;
  }
  std::uint32_t count = 0;
  for (std::uint32_t i = begin; i < end; ++i) {
    count += child_marks_[node.first_child + i] != 0 ? 1 : 0;
  }
  return count;
}

void WideTraversal::Walker::askMembers(const WideNode& node, std::uint32_t begin, std::uint32_t end,
                                       bool view_only) {
  found_.members.clear();
  found_.member_rest.clear();
  for (std::uint32_t i = begin; i < end; ++i) {
    const std::uint32_t child = node.first_child + i;
    if (child_marks_[child] != 0) {
      found_.members.push_back(wide_.boxes[child]);
      found_.member_rest.push_back(rest_[child]);
    }
  }
  const std::size_t count = found_.members.size();
  found_.member_answers.resize(std::max(found_.member_answers.size(), count));
  const std::span<BoxAnswer> answers = std::span(found_.member_answers).first(count);
  if (count > 0) {
    const std::uint32_t nodes_end = std::clamp<std::uint32_t>(node.node_count, begin, end);
    askMap(found_.members, found_.member_rest, members(node, begin, nodes_end), view_only, answers);
  }
  std::size_t next = 0;
  for (std::uint32_t i = begin; i < end; ++i) {
    const bool member = child_marks_[node.first_child + i] != 0;
    found_.answers[i] = member ? answers[next++] : BoxAnswer{.visibility = Visibility::kHidden};
  }
}

// Of children that the map does not hide, those that the window's may.
void WideTraversal::Walker::askFineMap(const WideNode& node, std::uint32_t begin, std::uint32_t end) {
  found_.asked_again.clear();
  found_.asked_child.clear();
  for (std::uint32_t i = begin; i < end; ++i) {
    const BoxAnswer& answer = found_.answers[i];
    if (answer.visibility == Visibility::kHidden || !answer.on_buffer) {
      continue;
    }
    if (i >= node.node_count) {
      found_.shown.push_back({answer.x, answer.y, 1});
    }
    const bool rests = rest_[node.first_child + i] != 0;
    if (maps_.fine != nullptr && !rests && maps_.window->about(answer.x, answer.y)) {
      found_.asked_again.push_back(wide_.boxes[node.first_child + i]);
      found_.asked_child.push_back(i);
    }
  }
  if (found_.asked_again.empty()) {
    return;
  }
  found_.second_answers.resize(std::max(found_.second_answers.size(), found_.asked_again.size()));
  maps_.fine->classify(found_.asked_again, std::span(found_.second_answers).first(found_.asked_again.size()),
                       {.plain_from = 0});
  for (std::size_t i = 0; i < found_.asked_again.size(); ++i) {
    const BoxAnswer& second = found_.second_answers[i];
    if (second.within_view && second.visibility == Visibility::kHidden) {
      found_.answers[found_.asked_child[i]].visibility = Visibility::kHidden;
      const std::uint32_t child = found_.asked_child[i];
      if (child < node.node_count) {
        const WideNode& hidden = wide_.nodes[node.first_node + child];
        const BoxAnswer& answer = found_.answers[child];
        found_.shown.push_back({answer.x, answer.y, hidden.object_end - hidden.first_object});
      }
    }
  }
}

void WideTraversal::Walker::keepNode(std::uint32_t node, const BoxAnswer& answer, bool view_only) {
  if (answer.visibility == Visibility::kHidden) {
    return;
  }
  const bool surely_visible = view_only || answer.visibility == Visibility::kVisible;
  if (!surely_visible || !answer.within_view) {
    found_.stack.push_back({node, surely_visible});
    return;
  }
  const WideNode& whole = wide_.nodes[node];
  for (std::uint32_t i = whole.first_object; i < whole.object_end; ++i) {
    const ObjectId object = hierarchy_.objects[i];
    if (in_set_.has(object)) {
      found_.kept.push_back(object);
    }
  }
}

}  // namespace sightline::culling
