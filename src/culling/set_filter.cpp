#include "src/culling/set_filter.h"

#include "src/culling/scene_fit.h"

namespace sightline::culling {
namespace {

TreeMarks marksOf(const Hierarchy& hierarchy, std::size_t object_count) {
  std::vector<std::uint32_t> parents(hierarchy.nodes.size(), TreeMarks::kTop);
  std::vector<TreeMarks::Place> places;
  for (std::uint32_t n = 0; n < hierarchy.nodes.size(); ++n) {
    const HierarchyNode& node = hierarchy.nodes[n];
    if (node.leaf()) {
      for (const ObjectId object : hierarchy.objectsBelow(NodeIndex(n))) {
        places.push_back({object, n});
      }
    } else {
      parents[hierarchy.left(NodeIndex(n)).value] = n;
      parents[hierarchy.right(NodeIndex(n)).value] = n;
    }
  }
  return {std::move(parents), places, object_count};
}

}  // namespace

SetFilter::SetFilter(const Hierarchy& hierarchy, std::span<const Box> object_bounds, VisibleSets* sets,
                     Marks marks)
    : sets_(sets != nullptr && isOf(sets->boxes(), object_bounds) ? sets : nullptr) {
  if (sets_ == nullptr) {
    return;
  }
  tree_ = sets_->boxes();
  if (marks == Marks::kAll) {
    node_marks_.emplace(marksOf(hierarchy, object_bounds.size()));
    object_marks_.resize(object_bounds.size());
    list_.reserve(object_bounds.size());
  }
}

bool SetFilter::find(const View& view) {
  VisibleSet set;
  // Sets hold for viewpoints, and the rays of an orthographic view do not start at its eye.
  if (sets_ != nullptr && !view.orthographic && treeIsTheSame()) {
    set = sets_->find(view.eye, nearDistance(view));
  }
  nodes_ = set.nodes;
  const bool another = !known_ || set.id != id_;
  known_ = true;
  id_ = set.id;
  if (another || everything()) {
    object_count_ = 0;
    for (const std::uint32_t node : nodes_) {
      object_count_ += tree_.nodes[node].object_count;
    }
  }
  if (another && !everything() && node_marks_) {
    mark();
  }
  return another;
}

// Whether boxes() still views the same memory. If the caller replaced the sets in place by others, it does
// not.
bool SetFilter::treeIsTheSame() const {
  const BoxTreeView now = sets_->boxes();
  return now.nodes.data() == tree_.nodes.data() && now.nodes.size() == tree_.nodes.size() &&
         now.objects.data() == tree_.objects.data() && now.objects.size() == tree_.objects.size();
}

void SetFilter::mark() {
  for (const ObjectId object : list_) {
    object_marks_[object.value] = 0;
  }
  list_.clear();
  for (const std::uint32_t node : nodes_) {
    const std::span<const ObjectId> below = tree_.objectsBelow(node);
    list_.insert(list_.end(), below.begin(), below.end());
  }
  for (const ObjectId object : list_) {
    object_marks_[object.value] = 1;
  }
  node_marks_->mark(list_);
}

}  // namespace sightline::culling
