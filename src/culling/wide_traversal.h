#pragma once

// Traverses a hierarchy with many children per node, for a depth pyramid that tests many boxes in one call.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sightline/base/parallel_for.h"
#include "sightline/culling/culling_method.h"
#include "sightline/hierarchy/hierarchy.h"
#include "sightline/occlusion/depth_pyramid.h"
#include "src/culling/hierarchical_traversal.h"
#include "src/culling/object_bits.h"
#include "src/culling/tree_marks.h"
#include "src/hierarchy/wide_hierarchy.h"

namespace sightline::culling {

class WideTraversal {
 public:
  // The hierarchy must outlive this; the boxes are copied.
  WideTraversal(const Hierarchy& hierarchy, std::span<const Box> object_bounds)
      : hierarchy_(hierarchy),
        wide_(hierarchy::collapse(hierarchy, object_bounds)),
        object_count_(object_bounds.size()),
        visible_(object_bounds.size()),
        retest_delay_(wide_.boxes.size(), 0),
        found_(kMaxRanges) {}

  // Appends the objects that may be visible to out, in ascending order, and adds to the counts of stats. With
  // options.temporal_coherence a box that was not hidden is not tested for occlusion again for a few views;
  // it is kept while it is in the view. The result does not depend on parallel_for.
  void run(const DepthPyramid& buffer, const TraversalOptions& options, CullStats& stats,
           std::vector<ObjectId>& out, const ParallelFor& parallel_for = serialFor);

  // From now on only objects of the set are tested and kept. The set's memory is not copied: call this again
  // whenever it changes.
  void restrictTo(const ObjectSet& objects);

  // Drops the knowledge of earlier views; call this when the camera jumps.
  void forget() { std::fill(retest_delay_.begin(), retest_delay_.end(), std::uint8_t{0}); }

 private:
  static constexpr std::uint32_t kMaxRanges = 64;

  struct Entry {
    std::uint32_t node;
    bool surely_visible;  // with respect to the occluders
  };

  // Traverses a part of the hierarchy; several may work at the same time.
  class Task;
  // Scratch and results of one task.
  struct Found {
    std::vector<Entry> stack;        // nodes to be visited
    std::vector<BoxAnswer> answers;  // by child of the current node
    // The children of the current node that are in the set, used if some are not: their boxes, the views
    // before they are tested again, and their answers.
    std::vector<Box> set_boxes;
    std::vector<std::uint8_t> set_retest_delay;
    std::vector<BoxAnswer> set_answers;
    std::vector<ObjectId> kept;
    std::uint32_t nodes_visited = 0, nodes_tested = 0, objects_tested = 0;
  };

  // Adds the results of a task to those of the view, and clears them.
  void take(Found& found, CullStats& stats);
  TreeMarks marksOfChildren() const;

  const Hierarchy& hierarchy_;
  hierarchy::WideHierarchy wide_;
  std::size_t object_count_;
  ObjectBits visible_;
  std::vector<std::uint8_t> retest_delay_;  // by child: views before it is tested for occlusion again
  ObjectSet in_set_;
  // By child: an object below it is in the set. Empty until restrictTo() gets a set without some object.
  std::optional<TreeMarks> child_marks_;
  std::vector<Entry> entries_;  // the nodes at which the tasks start
  std::vector<Found> found_;    // by the first entry of a task
};

}  // namespace sightline::culling
