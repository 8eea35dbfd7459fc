#pragma once

// The walk through a hierarchy of many children a node, for a structure that is asked about many boxes at
// once.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sightline/base/parallel_for.h"
#include "sightline/culling/culling_method.h"
#include "sightline/hierarchy/hierarchy.h"
#include "sightline/occlusion/depth_pyramid.h"
#include "src/culling/focus_window.h"
#include "src/culling/hierarchical_traversal.h"
#include "src/culling/object_bits.h"
#include "src/culling/tree_marks.h"
#include "src/hierarchy/wide_hierarchy.h"

namespace sightline::culling {

// What the walk asks: the map of the view, and the finer one of a window of it where there is one.
struct TraversalMaps {
  const DepthPyramid& map;
  FocusWindow* window = nullptr;       // is told what the map does not hide
  const DepthPyramid* fine = nullptr;  // of the window, when it is found
};

class WideTraversal {
 public:
  // The hierarchy must outlive this; the boxes are copied.
  WideTraversal(const Hierarchy& hierarchy, std::span<const Box> object_bounds)
      : hierarchy_(hierarchy),
        wide_(hierarchy::collapse(hierarchy, object_bounds)),
        object_count_(object_bounds.size()),
        visible_(object_bounds.size()),
        rest_(wide_.boxes.size(), 0),
        found_(kMaxRanges) {}

  // Appends the objects that may be seen to out, ascending, and adds to the counts of stats. With
  // options.temporal_coherence what was not hidden is not asked about again for a few views (it is kept
  // unless it leaves the view). Nothing depends on parallel_for.
  void run(const TraversalMaps& maps, const TraversalOptions& options, CullStats& stats,
           std::vector<ObjectId>& out, const ParallelFor& parallel_for = serialFor);

  // From now on only objects of the set are kept, and only they are asked about. To be called again whenever
  // what it views changes.
  void restrictTo(const ObjectSet& objects);

  // The next view has nothing to do with the last one.
  void forget() { std::fill(rest_.begin(), rest_.end(), std::uint8_t{0}); }

 private:
  static constexpr std::uint32_t kMaxRanges = 64;

  struct Entry {
    std::uint32_t node;
    bool surely_visible;  // with respect to the occluders
  };

  // Objects about a pixel that the map does not hide, see FocusWindow::add.
  struct Shown {
    std::uint16_t x, y;
    std::uint32_t objects;
  };
  // One of several that walk at the same time, with what it needs and what it finds.
  class Walker;
  struct Found {
    std::vector<Entry> stack;        // nodes to be visited
    std::vector<BoxAnswer> answers;  // of the children of one node
    std::vector<Box> members;        // of children: those in the set, where some are not
    std::vector<std::uint8_t> member_rest;
    std::vector<BoxAnswer> member_answers;
    std::vector<Box> asked_again;  // of the finer map
    std::vector<std::uint32_t> asked_child;
    std::vector<BoxAnswer> second_answers;
    std::vector<ObjectId> kept;
    std::vector<Shown> shown;
    std::uint32_t nodes_visited = 0, nodes_tested = 0, objects_tested = 0;
  };

  void take(Found& found, const TraversalMaps& maps, CullStats& stats);
  TreeMarks marksOfChildren() const;

  const Hierarchy& hierarchy_;
  hierarchy::WideHierarchy wide_;
  std::size_t object_count_;
  ObjectBits visible_;
  std::vector<std::uint8_t> rest_;  // by child: so many views it is not asked about
  ObjectSet in_set_;
  std::optional<TreeMarks> child_marks_;  // by child: some of it is in the set; after the first one
  std::vector<Entry> entries_;            // below which several may walk
  std::vector<Found> found_;              // by the first entry of a range
};

}  // namespace sightline::culling
