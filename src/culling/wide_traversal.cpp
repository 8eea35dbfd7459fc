#include "src/culling/wide_traversal.h"

#include <algorithm>

namespace sightline::culling {

using hierarchy::kWideChildren;
using hierarchy::WideNode;

namespace {
// Number of views for which a box is not tested again after it was found not hidden; up to 3 are added.
constexpr std::uint8_t kMinRetestDelay = 6;
}  // namespace

class WideTraversal::Task {
 public:
  Task(WideTraversal& traversal, const DepthPyramid& buffer, const TraversalOptions& options, Found& found)
      : hierarchy_(traversal.hierarchy_),
        wide_(traversal.wide_),
        retest_delay_(traversal.retest_delay_),
        in_set_(traversal.in_set_),
        child_marks_(traversal.child_marks_ ? traversal.child_marks_->marks()
                                            : std::span<const std::uint8_t>()),
        buffer_(buffer),
        options_(options),
        found_(found) {}

  // Tests the children of a node: appends the objects to keep to found.kept, and the nodes to visit to
  // found.stack.
  void visit(const Entry& entry);

 private:
  // The functions below are about the node's children `begin` (inclusive) to `end` (exclusive).
  // Counts those that are in the set.
  std::uint32_t countInSet(const WideNode& node, std::uint32_t begin, std::uint32_t end) const;
  // Writes their answers to found.answers: against the occluders, or with view_only against the view's volume
  // alone. Children that are not in the set count as hidden.
  void test(const WideNode& node, std::uint32_t begin, std::uint32_t end, bool view_only);
  void testInSet(const WideNode& node, std::uint32_t begin, std::uint32_t end, bool view_only);
  void testBuffer(std::span<const Box> boxes, std::span<const std::uint8_t> retest_delay,
                  std::size_t plain_from, bool view_only, std::span<BoxAnswer> answers);
  void keepNode(std::uint32_t node, const BoxAnswer& answer, bool view_only);

  const Hierarchy& hierarchy_;
  const hierarchy::WideHierarchy& wide_;
  std::span<std::uint8_t> retest_delay_;
  ObjectSet in_set_;
  std::span<const std::uint8_t> child_marks_;  // empty if all objects are in the set
  const DepthPyramid& buffer_;
  const TraversalOptions& options_;
  Found& found_;
};

void WideTraversal::run(const DepthPyramid& buffer, const TraversalOptions& options, CullStats& stats,
                        std::vector<ObjectId>& out, const ParallelFor& parallel_for) {
  entries_.clear();
  if (!wide_.nodes.empty()) {
    // The root itself is never tested, only its children. So its own cost decides here.
    entries_.push_back({0, wide_.nodes[0].cost < options.min_node_cost});
  }
  // Descend level by level until there are enough entries to distribute to tasks.
  Found& first = found_[0];
  std::size_t next = 0;
  while (next < entries_.size() && entries_.size() - next < kMaxRanges - kWideChildren) {
    Task(*this, buffer, options, first).visit(entries_[next++]);
    entries_.insert(entries_.end(), first.stack.begin(), first.stack.end());
    first.stack.clear();
  }
  take(first, stats);
  entries_.erase(entries_.begin(), entries_.begin() + static_cast<std::ptrdiff_t>(next));
  const auto count = static_cast<std::uint32_t>(entries_.size());
  // ParallelFor's function captures one reference only: larger captures would be allocated on the heap.
  const auto traverseRange = [&](std::uint32_t begin, std::uint32_t end) {
    Found& found = found_[begin];
    Task task(*this, buffer, options, found);
    for (std::uint32_t i = begin; i < end; ++i) {
      found.stack.push_back(entries_[i]);
      while (!found.stack.empty()) {
        const Entry entry = found.stack.back();
        found.stack.pop_back();
        task.visit(entry);
      }
    }
  };
  parallel_for(count,
               [&traverseRange](std::uint32_t begin, std::uint32_t end) { traverseRange(begin, end); });
  for (std::uint32_t i = 0; i < count; ++i) {
    take(found_[i], stats);
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
  // Reset the delay of children outside the set: it is out of date when they come back.
  for (std::size_t child = 0; child < retest_delay_.size(); ++child) {
    retest_delay_[child] &= child_marks_->marks()[child];
  }
}

void WideTraversal::take(Found& found, CullStats& stats) {
  for (const ObjectId object : found.kept) {
    visible_.insert(object);
  }
  stats.nodes_visited += found.nodes_visited;
  stats.nodes_tested += found.nodes_tested;
  stats.objects_tested += found.objects_tested;
  found.kept.clear();
  found.nodes_visited = found.nodes_tested = found.objects_tested = 0;
}

void WideTraversal::Task::visit(const Entry& entry) {
  const WideNode& node = wide_.nodes[entry.node];
  const std::uint32_t children = node.child_end - node.first_child;
  // Child nodes are sorted by descending cost, so those to be tested are the first ones.
  std::uint32_t tested = entry.surely_visible ? 0 : node.node_count;
  while (tested > 0 && wide_.nodes[node.first_node + tested - 1].cost < options_.min_node_cost) {
    --tested;
  }
  const bool test_objects = !entry.surely_visible && options_.test_objects;
  found_.answers.resize(std::max<std::size_t>(found_.answers.size(), children));
  if (tested == node.node_count && test_objects) {
    test(node, 0, children, false);
  } else {
    test(node, 0, tested, false);
    test(node, tested, node.node_count, true);
    test(node, node.node_count, children, !test_objects);
  }
  found_.nodes_visited += countInSet(node, 0, node.node_count);
  found_.nodes_tested += countInSet(node, 0, tested);
  found_.objects_tested += test_objects ? countInSet(node, node.node_count, children) : 0;

  for (std::uint32_t i = 0; i < node.node_count; ++i) {
    keepNode(node.first_node + i, found_.answers[i], i >= tested);
  }
  for (std::uint32_t i = node.node_count; i < children; ++i) {
    if (found_.answers[i].visibility != Visibility::kHidden) {
      found_.kept.push_back(wide_.object[node.first_child + i]);
    }
  }
}

void WideTraversal::Task::test(const WideNode& node, std::uint32_t begin, std::uint32_t end, bool view_only) {
  if (begin == end) {
    return;
  }
  const std::span<BoxAnswer> answers = std::span(found_.answers).subspan(begin, end - begin);
  const std::span<std::uint8_t> retest_delay = retest_delay_.subspan(node.first_child + begin, end - begin);
  if (countInSet(node, begin, end) == end - begin) {
    const std::span<const Box> boxes = std::span(wide_.boxes).subspan(node.first_child + begin, end - begin);
    testBuffer(boxes, retest_delay, node.node_count > begin ? node.node_count - begin : 0, view_only,
               answers);
  } else {
    testInSet(node, begin, end, view_only);
  }
  if (view_only) {
    return;
  }
  for (std::size_t i = 0; options_.temporal_coherence && i < retest_delay.size(); ++i) {
    const bool hidden = answers[i].visibility == Visibility::kHidden;
    // The delays differ so that children that come into view together are not all tested again in one view.
    std::uint8_t& delay = retest_delay[i];
    delay = static_cast<std::uint8_t>(hidden ? 0u : delay != 0 ? delay - 1u : kMinRetestDelay + (i & 3));
  }
}

void WideTraversal::Task::testBuffer(std::span<const Box> boxes, std::span<const std::uint8_t> retest_delay,
                                     std::size_t plain_from, bool view_only, std::span<BoxAnswer> answers) {
  if (view_only) {
    buffer_.classifyInView(boxes, answers);
    return;
  }
  BoxHints hints;
  if (options_.temporal_coherence) {
    hints.seen = retest_delay;
  }
  hints.plain_from = plain_from;
  buffer_.classify(boxes, answers, hints);
}

std::uint32_t WideTraversal::Task::countInSet(const WideNode& node, std::uint32_t begin,
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

void WideTraversal::Task::testInSet(const WideNode& node, std::uint32_t begin, std::uint32_t end,
                                    bool view_only) {
  found_.set_boxes.clear();
  found_.set_retest_delay.clear();
  for (std::uint32_t i = begin; i < end; ++i) {
    const std::uint32_t child = node.first_child + i;
    if (child_marks_[child] != 0) {
      found_.set_boxes.push_back(wide_.boxes[child]);
      found_.set_retest_delay.push_back(retest_delay_[child]);
    }
  }
  const std::size_t count = found_.set_boxes.size();
  found_.set_answers.resize(std::max(found_.set_answers.size(), count));
  const std::span<BoxAnswer> answers = std::span(found_.set_answers).first(count);
  if (count > 0) {
    const std::uint32_t nodes_end = std::clamp<std::uint32_t>(node.node_count, begin, end);
    testBuffer(found_.set_boxes, found_.set_retest_delay, countInSet(node, begin, nodes_end), view_only,
               answers);
  }
  std::size_t next = 0;
  for (std::uint32_t i = begin; i < end; ++i) {
    const bool in_set = child_marks_[node.first_child + i] != 0;
    found_.answers[i] = in_set ? answers[next++] : BoxAnswer{.visibility = Visibility::kHidden};
  }
}

void WideTraversal::Task::keepNode(std::uint32_t node, const BoxAnswer& answer, bool view_only) {
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
