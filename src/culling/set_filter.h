#pragma once

// The potentially visible set of a view, and what it leaves of a hierarchy's nodes and objects.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sightline/base/ids.h"
#include "sightline/hierarchy/hierarchy.h"
#include "sightline/occlusion/visible_sets.h"
#include "sightline/scene/camera.h"
#include "src/culling/tree_marks.h"

namespace sightline::culling {

class SetFilter {
 public:
  // What is asked for: the set's nodes alone, or marks at objects and nodes of the hierarchy too.
  enum class Marks : std::uint8_t { kNone, kAll };

  // The hierarchy is of these boxes. sets: null for none; not used either where it is of other boxes.
  SetFilter(const Hierarchy& hierarchy, std::span<const Box> object_bounds, VisibleSets* sets, Marks marks);

  // Finds the set of the view. True when it is not the one of the call before.
  bool find(const View& view);

  // Of the last find(). Everything may be seen: there is no set, or the sets know nothing of the view.
  bool everything() const { return id_ == VisibleSet::kEverything; }
  // Of sets.boxes(); until the next find(). Empty where there is no set.
  std::span<const std::uint32_t> nodes() const { return nodes_; }
  BoxTreeView boxes() const { return tree_; }
  std::uint32_t objectCount() const { return object_count_; }

  // With marks. Valid until the next find().
  ObjectSet objects() const { return everything() ? ObjectSet{} : ObjectSet{object_marks_, list_}; }
  bool hasObject(ObjectId object) const { return everything() || object_marks_[object.value] != 0; }
  // Whether anything below the hierarchy's node is in the set.
  bool hasNode(std::uint32_t node) const { return everything() || node_marks_->marks()[node] != 0; }

 private:
  void mark();

  bool treeIsTheSame() const;

  VisibleSets* sets_;
  BoxTreeView tree_;    // of the sets, as the constructor saw it
  bool known_ = false;  // id_ is the last find()'s
  std::uint32_t id_ = VisibleSet::kEverything;
  std::uint32_t object_count_ = 0;
  std::span<const std::uint32_t> nodes_;
  std::optional<TreeMarks> node_marks_;     // with marks
  std::vector<std::uint8_t> object_marks_;  // with marks
  std::vector<ObjectId> list_;              // what is marked
};

}  // namespace sightline::culling
