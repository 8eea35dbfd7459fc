#include "src/culling/wide_traversal.h"

#include <algorithm>

#include "src/culling/hiding_aims.h"

namespace sightline::culling {

using hierarchy::WideNode;

namespace {
// Number of views for which a box is not tested again after it was found not hidden; up to 3 are added.
constexpr std::uint8_t kMinRetestDelay = 6;
// Children are tested together from so many on, or when there are no more.
constexpr std::size_t kBatch = 256;
}  // namespace

// Tests children in batches, whichever nodes they are of: a vector has a box in each lane.
class WideTraversal::Task {
 public:
  Task(WideTraversal& traversal, const DepthPyramid& buffer, const TraversalOptions& options, Found& found)
      : hierarchy_(traversal.hierarchy_),
        wide_(traversal.wide_),
        retest_delay_(traversal.retest_delay_),
        seen_points_(traversal.seen_points_),
        in_set_(traversal.in_set_),
        child_marks_(traversal.child_marks_ ? traversal.child_marks_->marks()
                                            : std::span<const std::uint8_t>()),
        buffer_(buffer),
        options_(options),
        found_(found) {}

  // Visits these nodes. Appends the objects to keep to found.kept, and the nodes to visit to found.stack.
  void visit(std::span<const Entry> entries);
  // Visits all nodes of found.stack, and those below them.
  void visitAll();
  // Tests objects, and appends those that the buffer does not hide to found.kept.
  void test(std::span<const ObjectId> objects, std::span<const std::uint32_t> child_of_object);

 private:
  // Lists the children of a node that are to be tested.
  void list(const Entry& entry);
  // The same for the node's children `begin` (inclusive) to `end` (exclusive). Returns how many.
  std::uint32_t list(const WideNode& node, std::uint32_t begin, std::uint32_t end,
                     std::vector<Child>& children) const;
  // Test all children that are listed, and keep what is not hidden.
  void testNodes();
  void testObjects();

  // Sets found.points, and found.seen where they are seen.
  void askPoints(std::span<const Child> children);
  // Sets found.answers against the occluders, and where the children were seen to found.points, which has
  // their points. plain_from and not_hidden: see BoxHints.
  void testBuffer(std::span<const Child> children, std::size_t plain_from,
                  std::span<const std::uint8_t> not_hidden);
  // Sets found.answers against the view's volume alone.
  void testInView(std::span<const Child> children);
  // Sets found.boxes, and makes room for their answers.
  void gatherBoxes(std::span<const Child> children);
  void updateDelay(const Child& child, bool hidden);
  void noteHidden(const Child& child, const BoxAnswer& answer);
  void keepObject(const Child& child);
  void keepNode(std::uint32_t node, const BoxAnswer& answer, bool view_only);

  const Hierarchy& hierarchy_;
  const hierarchy::WideHierarchy& wide_;
  std::span<std::uint8_t> retest_delay_;
  std::span<Vec3f> seen_points_;
  ObjectSet in_set_;
  std::span<const std::uint8_t> child_marks_;  // empty if all objects are in the set
  const DepthPyramid& buffer_;
  const TraversalOptions& options_;
  Found& found_;
};

void WideTraversal::run(const DepthPyramid& buffer, const TraversalOptions& options, CullStats& stats,
                        std::vector<ObjectId>& out, const ParallelFor& parallel_for) {
  entries_.clear();
  hidden_children_.clear();
  some_delayed_ = some_delayed_ || options.temporal_coherence;
  if (!wide_.nodes.empty()) {
    // The root itself is never tested, only its children. So its own cost decides here.
    entries_.push_back({0, wide_.nodes[0].cost < options.min_node_cost});
  }
  // Descend level by level until there are enough entries to distribute to tasks.
  Found& first = found_[0];
  while (!entries_.empty() && entries_.size() < kMaxRanges) {
    Task(*this, buffer, options, first).visit(entries_);
    entries_.swap(first.stack);
    first.stack.clear();
  }
  take(first, stats);
  const std::size_t count = entries_.size();
  const auto tasks = static_cast<std::uint32_t>(std::min<std::size_t>(count, kMaxRanges));
  // ParallelFor's function captures one reference only: larger captures would be allocated on the heap.
  const auto traverseRange = [&](std::uint32_t begin, std::uint32_t end) {
    if (begin == end) {
      return;  // an empty range has no task whose results it could write
    }
    Found& found = found_[begin];
    const auto entryOf = [&](std::uint32_t task) {
      return entries_.begin() + static_cast<std::ptrdiff_t>(count * task / tasks);
    };
    found.stack.assign(entryOf(begin), entryOf(end));
    Task(*this, buffer, options, found).visitAll();
  };
  parallel_for(tasks,
               [&traverseRange](std::uint32_t begin, std::uint32_t end) { traverseRange(begin, end); });
  for (std::uint32_t i = 0; i < tasks; ++i) {
    take(found_[i], stats);
  }
  visible_.drainInto(out);
  hidden_.drainInto(hidden_children_);
}

void WideTraversal::testAgain(const DepthPyramid& buffer, const TraversalOptions& options, CullStats& stats,
                              std::vector<ObjectId>& objects, const ParallelFor& parallel_for) {
  const std::size_t count = objects.size();
  const auto tasks =
      static_cast<std::uint32_t>(std::min<std::size_t>((count + kBatch - 1) / kBatch, kMaxRanges));
  const auto testPart = [&](std::uint32_t begin, std::uint32_t end) {
    if (begin == end) {
      return;  // there may be no task at all
    }
    const std::size_t first = count * begin / tasks;
    Task(*this, buffer, options, found_[begin])
        .test(std::span(objects).subspan(first, count * end / tasks - first), child_of_object_);
  };
  // ParallelFor's function captures one reference only: larger captures would be allocated on the heap.
  parallel_for(tasks, [&testPart](std::uint32_t begin, std::uint32_t end) { testPart(begin, end); });
  for (std::uint32_t i = 0; i < tasks; ++i) {
    take(found_[i], stats);
  }
  objects.clear();
  visible_.drainInto(objects);
  hidden_.drainInto(hidden_children_);
}

void WideTraversal::appendHidden(std::size_t most, std::size_t turn, std::vector<Box>& boxes) const {
  spreadOver(hidden_children_.size(), most, turn,
             [&](std::size_t i) { boxes.push_back(wide_.boxes[hidden_children_[i].value]); });
}

std::vector<std::uint32_t> WideTraversal::childrenByObject(const hierarchy::WideHierarchy& wide,
                                                           std::size_t objects) {
  std::vector<std::uint32_t> children(objects);
  for (const WideNode& node : wide.nodes) {
    for (std::uint32_t child = node.first_child + node.node_count; child < node.child_end; ++child) {
      children[wide.object[child].value] = child;
    }
  }
  return children;
}

std::vector<Vec3f> WideTraversal::centresOf(std::span<const Box> boxes) {
  std::vector<Vec3f> centres;
  centres.reserve(boxes.size());
  for (const Box& box : boxes) {
    centres.push_back(Vec3f(center(box)));
  }
  return centres;
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
  for (std::size_t child = 0; some_delayed_ && child < retest_delay_.size(); ++child) {
    retest_delay_[child] &= child_marks_->marks()[child];
  }
}

void WideTraversal::forget() {
  if (some_delayed_) {
    std::fill(retest_delay_.begin(), retest_delay_.end(), std::uint8_t{0});
    some_delayed_ = false;
  }
}

void WideTraversal::take(Found& found, CullStats& stats) {
  for (const ObjectId object : found.kept) {
    visible_.insert(object);
  }
  for (const std::uint32_t child : found.hidden) {
    hidden_.insert(ObjectId(child));
  }
  stats.nodes_visited += found.nodes_visited;
  stats.nodes_tested += found.nodes_tested;
  stats.objects_tested += found.objects_tested;
  found.kept.clear();
  found.hidden.clear();
  found.nodes_visited = found.nodes_tested = found.objects_tested = 0;
}

void WideTraversal::Task::visit(std::span<const Entry> entries) {
  for (const Entry& entry : entries) {
    list(entry);
  }
  testNodes();
  testObjects();
}

void WideTraversal::Task::visitAll() {
  while (!found_.stack.empty()) {
    while (!found_.stack.empty() && found_.nodes.size() + found_.nodes_in_view.size() < kBatch) {
      const Entry entry = found_.stack.back();
      found_.stack.pop_back();
      list(entry);
    }
    testNodes();
    if (found_.objects.size() + found_.objects_in_view.size() >= kBatch) {
      testObjects();
    }
  }
  testObjects();
}

void WideTraversal::Task::test(std::span<const ObjectId> objects,
                               std::span<const std::uint32_t> child_of_object) {
  for (const ObjectId object : objects) {
    found_.objects.push_back({child_of_object[object.value], object.value, 0});
  }
  found_.objects_tested += static_cast<std::uint32_t>(objects.size());
  testObjects();
}

void WideTraversal::Task::list(const Entry& entry) {
  const WideNode& node = wide_.nodes[entry.node];
  const std::uint32_t children = node.child_end - node.first_child;
  // Child nodes are sorted by descending cost, so those to be tested are the first ones.
  std::uint32_t tested = entry.surely_visible ? 0 : node.node_count;
  while (tested > 0 && wide_.nodes[node.first_node + tested - 1].cost < options_.min_node_cost) {
    --tested;
  }
  const bool test_objects = !entry.surely_visible && options_.test_objects;
  const std::uint32_t nodes_tested = list(node, 0, tested, found_.nodes);
  found_.nodes_tested += nodes_tested;
  found_.nodes_visited += nodes_tested + list(node, tested, node.node_count, found_.nodes_in_view);
  if (test_objects) {
    found_.objects_tested += list(node, node.node_count, children, found_.objects);
  } else {
    list(node, node.node_count, children, found_.objects_in_view);
  }
}

std::uint32_t WideTraversal::Task::list(const WideNode& node, std::uint32_t begin, std::uint32_t end,
                                        std::vector<Child>& children) const {
  const std::size_t before = children.size();
  for (std::uint32_t i = begin; i < end; ++i) {
    const std::uint32_t child = node.first_child + i;
    if (in_set_.everything() || child_marks_[child] != 0) {
      children.push_back({child, i < node.node_count ? node.first_node + i : wide_.object[child].value, i});
    }
  }
  return static_cast<std::uint32_t>(children.size() - before);
}

void WideTraversal::Task::testNodes() {
  if (!found_.nodes.empty()) {
    askPoints(found_.nodes);
    testBuffer(found_.nodes, found_.nodes.size(), std::span(found_.seen).first(found_.nodes.size()));
    for (std::size_t i = 0; i < found_.nodes.size(); ++i) {
      const BoxAnswer& answer = found_.answers[i];
      updateDelay(found_.nodes[i], answer.visibility == Visibility::kHidden);
      noteHidden(found_.nodes[i], answer);
      keepNode(found_.nodes[i].number, answer, false);
    }
    found_.nodes.clear();
  }
  if (!found_.nodes_in_view.empty()) {
    testInView(found_.nodes_in_view);
    for (std::size_t i = 0; i < found_.nodes_in_view.size(); ++i) {
      keepNode(found_.nodes_in_view[i].number, found_.answers[i], true);
    }
    found_.nodes_in_view.clear();
  }
}

void WideTraversal::Task::testObjects() {
  std::vector<Child>& objects = found_.objects;
  if (!objects.empty()) {
    askPoints(objects);
    std::size_t left = 0;
    for (std::size_t i = 0; i < objects.size(); ++i) {
      if (found_.seen[i] != 0) {
        keepObject(objects[i]);
        updateDelay(objects[i], false);
      } else {
        objects[left] = objects[i];
        found_.points[left++] = found_.points[i];
      }
    }
    objects.resize(left);
    testBuffer(objects, 0, {});
    for (std::size_t i = 0; i < left; ++i) {
      const bool hidden = found_.answers[i].visibility == Visibility::kHidden;
      updateDelay(objects[i], hidden);
      noteHidden(objects[i], found_.answers[i]);
      if (!hidden) {
        keepObject(objects[i]);
      }
    }
    objects.clear();
  }
  if (!found_.objects_in_view.empty()) {
    testInView(found_.objects_in_view);
    for (std::size_t i = 0; i < found_.objects_in_view.size(); ++i) {
      if (found_.answers[i].visibility != Visibility::kHidden) {
        keepObject(found_.objects_in_view[i]);
      }
    }
    found_.objects_in_view.clear();
  }
}

void WideTraversal::Task::askPoints(std::span<const Child> children) {
  found_.points.clear();
  for (const Child& child : children) {
    found_.points.push_back(seen_points_[child.index]);
  }
  found_.seen.resize(children.size());
  buffer_.seesPoints(found_.points, found_.seen);
}

void WideTraversal::Task::testBuffer(std::span<const Child> children, std::size_t plain_from,
                                     std::span<const std::uint8_t> not_hidden) {
  gatherBoxes(children);
  BoxHints hints;
  if (options_.temporal_coherence) {
    found_.retest_delay.clear();
    for (const Child& child : children) {
      found_.retest_delay.push_back(retest_delay_[child.index]);
    }
    hints.retest_delay = found_.retest_delay;
  }
  hints.plain_from = plain_from;
  hints.not_hidden = not_hidden;
  hints.seen_points = std::span(found_.points).first(children.size());
  buffer_.classify(found_.boxes, found_.answers, hints);
  for (std::size_t i = 0; i < children.size(); ++i) {
    seen_points_[children[i].index] = found_.points[i];
  }
}

void WideTraversal::Task::testInView(std::span<const Child> children) {
  gatherBoxes(children);
  buffer_.classifyInView(found_.boxes, found_.answers);
}

void WideTraversal::Task::gatherBoxes(std::span<const Child> children) {
  found_.boxes.clear();
  for (const Child& child : children) {
    found_.boxes.push_back(wide_.boxes[child.index]);
  }
  found_.answers.resize(children.size());
}

void WideTraversal::Task::updateDelay(const Child& child, bool hidden) {
  if (options_.temporal_coherence) {
    // The delays differ so that children that come into view together are not all tested again in one view.
    std::uint8_t& delay = retest_delay_[child.index];
    delay = static_cast<std::uint8_t>(hidden       ? 0u
                                      : delay != 0 ? delay - 1u
                                                   : kMinRetestDelay + (child.place & 3));
  }
}

// What lies beside the view is not hidden by the buffer.
void WideTraversal::Task::noteHidden(const Child& child, const BoxAnswer& answer) {
  if (answer.visibility == Visibility::kHidden && answer.on_buffer) {
    found_.hidden.push_back(child.index);
  }
}

void WideTraversal::Task::keepObject(const Child& child) {
  found_.kept.push_back(ObjectId(child.number));
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
