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
        child_of_object_(childrenByObject(wide_, object_bounds.size())),
        object_count_(object_bounds.size()),
        visible_(object_bounds.size()),
        hidden_(wide_.boxes.size()),
        retest_delay_(wide_.boxes.size(), 0),
        seen_points_(centresOf(wide_.boxes)),
        found_(kMaxRanges) {}

  // Appends the objects that may be visible to out, in ascending order, and adds to the counts of stats. With
  // options.temporal_coherence a box that was not hidden is not tested for occlusion again for a few views;
  // it is kept while it is in the view. The result does not depend on parallel_for.
  void run(const DepthPyramid& buffer, const TraversalOptions& options, CullStats& stats,
           std::vector<ObjectId>& out, const ParallelFor& parallel_for = serialFor);

  // Removes from the objects that run() appended for the same view those that the buffer hides, now that more
  // is drawn. Each is tested by its own box, also with options.min_node_cost; no node is visited. Not for
  // options.temporal_coherence. The result does not depend on parallel_for.
  void testAgain(const DepthPyramid& buffer, const TraversalOptions& options, CullStats& stats,
                 std::vector<ObjectId>& objects, const ParallelFor& parallel_for = serialFor);

  // Appends boxes of nodes and objects that the depth buffer hid in the last view, at most `most` of them.
  // Where there are more they are spread over all of them, others in each turn.
  void appendHidden(std::size_t most, std::size_t turn, std::vector<Box>& boxes) const;

  // From now on only objects of the set are tested and kept. The set's memory is not copied: call this again
  // whenever it changes.
  void restrictTo(const ObjectSet& objects);

  // Drops the knowledge of earlier views that the answers depend on; call this when the camera jumps.
  void forget();

 private:
  static constexpr std::uint32_t kMaxRanges = 64;

  struct Entry {
    std::uint32_t node;
    bool surely_visible;  // with respect to the occluders
  };

  // Traverses a part of the hierarchy; several may work at the same time.
  class Task;
  // A child of a node, to be tested.
  struct Child {
    std::uint32_t index;   // in WideHierarchy::boxes
    std::uint32_t number;  // of its node, or of its object
    std::uint32_t place;   // among the children of its node
  };
  // Scratch and results of one task.
  struct Found {
    std::vector<Entry> stack;  // nodes to be visited
    // Children of the nodes visited so far, to be tested together: against the occluders, or against the
    // view's volume alone.
    std::vector<Child> nodes, objects, nodes_in_view, objects_in_view;
    // These have a value for each of the children that are tested in one call.
    std::vector<Box> boxes;
    std::vector<Vec3f> points;  // of seen_points_
    std::vector<std::uint8_t> seen, retest_delay;
    std::vector<BoxAnswer> answers;
    std::vector<ObjectId> kept;
    std::vector<std::uint32_t> hidden;  // children, by index, that the buffer hides
    std::uint32_t nodes_visited = 0, nodes_tested = 0, objects_tested = 0;
  };

  // The index of the child that each object is.
  static std::vector<std::uint32_t> childrenByObject(const hierarchy::WideHierarchy& wide,
                                                     std::size_t objects);
  static std::vector<Vec3f> centresOf(std::span<const Box> boxes);
  // Adds the results of a task to those of the view, and clears them.
  void take(Found& found, CullStats& stats);
  TreeMarks marksOfChildren() const;

  const Hierarchy& hierarchy_;
  hierarchy::WideHierarchy wide_;
  std::vector<std::uint32_t> child_of_object_;
  std::size_t object_count_;
  ObjectBits visible_;
  // Children, in place of objects, that the buffer hid in this run, and those of the last view: ascending,
  // and then, ascending too, what testAgain() found.
  ObjectBits hidden_;
  std::vector<ObjectId> hidden_children_;
  std::vector<std::uint8_t> retest_delay_;  // by child: views before it is tested for occlusion again
  bool some_delayed_ = false;               // not all delays are 0
  // By child: a point of its box at which it was last seen, first its centre. Where that is still seen, an
  // object is kept untested, and of a node only kVisible and kPartial are told apart; the answers do not
  // depend on it.
  std::vector<Vec3f> seen_points_;
  ObjectSet in_set_;
  // By child: an object below it is in the set. Empty until restrictTo() gets a set without some object.
  std::optional<TreeMarks> child_marks_;
  std::vector<Entry> entries_;  // the nodes at which the tasks start
  std::vector<Found> found_;    // by task, the first entry of its range
};

}  // namespace sightline::culling
