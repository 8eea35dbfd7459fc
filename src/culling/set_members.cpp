#include "culling/set_members.h"

namespace sightline::culling_detail {
namespace {

// Whether the tree has each of so many objects once: a set of any other tree would hide what it does not
// know.
bool holdsAll(const BoxTreeView& tree, std::size_t object_count) {
  std::vector<bool> found(object_count, false);
  for (const ObjectId object : tree.objects) {
    if (object.value >= object_count || found[object.value]) {
      return false;
    }
    found[object.value] = true;
  }
  return tree.objects.size() == object_count;
}

TreeMarks marksOf(const Hierarchy& hierarchy, std::size_t object_count) {
  std::vector<std::uint32_t> parents(hierarchy.nodes.size(), TreeMarks::kTop);
  std::vector<TreeMarks::Place> places;
  for (std::uint32_t n = 0; n < hierarchy.nodes.size(); ++n) {
    const HierarchyNode& node = hierarchy.nodes[n];
    if (node.leaf()) {
      for (std::uint32_t i = 0; i < node.leaf_count; ++i) {
        places.push_back({hierarchy.objects[node.link + i], n});
      }
    } else {
      parents[hierarchy.left(NodeIndex(n)).value] = n;
      parents[hierarchy.right(NodeIndex(n)).value] = n;
    }
  }
  return {std::move(parents), places, object_count};
}

}  // namespace

SetMembers::SetMembers(const Hierarchy& hierarchy, std::size_t object_count, VisibleSets* sets, Marks marks)
    : sets_(sets != nullptr && holdsAll(sets->boxes(), object_count) ? sets : nullptr) {
  if (sets_ != nullptr && marks == Marks::kAll) {
    node_marks_.emplace(marksOf(hierarchy, object_count));
    object_marks_.resize(object_count);
    list_.reserve(object_count);
  }
}

bool SetMembers::find(const View& view) {
  VisibleSet set;
  // From an orthographic view's eye nothing is looked at.
  if (sets_ != nullptr && !view.orthographic) {
    set = sets_->find(view.eye, nearDistance(view));
  }
  nodes_ = set.nodes;
  const bool another = !known_ || set.id != id_;
  known_ = true;
  id_ = set.id;
  if (another || everything()) {
    object_count_ = 0;
    const BoxTreeView tree = boxes();
    for (const std::uint32_t node : nodes_) {
      object_count_ += tree.nodes[node].object_count;
    }
  }
  if (another && !everything() && node_marks_) {
    mark();
  }
  return another;
}

void SetMembers::mark() {
  for (const ObjectId object : list_) {
    object_marks_[object.value] = 0;
  }
  list_.clear();
  const BoxTreeView tree = sets_->boxes();
  for (const std::uint32_t node : nodes_) {
    const std::span<const ObjectId> below = tree.objectsBelow(node);
    list_.insert(list_.end(), below.begin(), below.end());
  }
  for (const ObjectId object : list_) {
    object_marks_[object.value] = 1;
  }
  node_marks_->mark(list_);
}

}  // namespace sightline::culling_detail
