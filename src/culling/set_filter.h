#pragma once

// Looks up the potentially visible set of a view, and tells which nodes and objects of a hierarchy are in it.

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
  // What find() provides: the set's nodes alone, or also marks for the objects and nodes of the hierarchy.
  enum class Marks : std::uint8_t { kNone, kAll };

  // The hierarchy must have been built from these boxes. sets: may be null; sets of other boxes are not used.
  SetFilter(const Hierarchy& hierarchy, std::span<const Box> object_bounds, VisibleSets* sets, Marks marks);

  // False if there are no sets, or sets of other boxes.
  bool usesSets() const { return sets_ != nullptr; }
  // Finds the set of the view. Returns true if it differs from that of the last call.
  bool find(const View& view);

  // True if the last find() found no set for the view, so that every object may be visible.
  bool everything() const { return id_ == VisibleSet::kEverything; }
  // The nodes of the set in boxes(), valid until the next find(). Empty if there is no set.
  std::span<const std::uint32_t> nodes() const { return nodes_; }
  BoxTreeView boxes() const { return tree_; }
  // Number of objects in the set; 0 if there is no set.
  std::uint32_t objectCount() const { return object_count_; }

  // The functions below require Marks::kAll; their results are valid until the next find().
  ObjectSet objects() const { return everything() ? ObjectSet{} : ObjectSet{object_marks_, list_}; }
  bool hasObject(ObjectId object) const { return everything() || object_marks_[object.value] != 0; }
  // Whether an object below the hierarchy's node is in the set.
  bool hasNode(std::uint32_t node) const { return everything() || node_marks_->marks()[node] != 0; }

 private:
  void mark();

  bool treeIsTheSame() const;

  VisibleSets* sets_;
  BoxTreeView tree_;    // sets_->boxes() at the time of construction
  bool known_ = false;  // true after the first find()
  std::uint32_t id_ = VisibleSet::kEverything;
  std::uint32_t object_count_ = 0;
  std::span<const std::uint32_t> nodes_;
  // These are used with Marks::kAll only.
  std::optional<TreeMarks> node_marks_;
  std::vector<std::uint8_t> object_marks_;  // by object
  std::vector<ObjectId> list_;              // the marked objects
};

}  // namespace sightline::culling
