#pragma once

// The walk through a hierarchy of many children a node, for a structure that is asked about many boxes at
// once.

#include <cstdint>
#include <span>
#include <vector>

#include "culling/focus_window.h"
#include "culling/hierarchical_walk.h"
#include "culling/object_bits.h"
#include "hierarchy/wide_hierarchy.h"
#include "sightline/culling/culler.h"
#include "sightline/hierarchy/hierarchy.h"
#include "sightline/occlusion/depth_pyramid.h"

namespace sightline::culling_detail {

// What the walk asks: the map of the view, and the finer one of a window of it where there is one.
struct WalkMaps {
  const DepthPyramid& map;
  FocusWindow* window = nullptr;       // is told what the map does not hide
  const DepthPyramid* fine = nullptr;  // of the window, when it is found
};

class WideWalk {
 public:
  // The hierarchy must outlive this; the boxes are copied.
  WideWalk(const Hierarchy& hierarchy, std::span<const Box> object_bounds)
      : hierarchy_(hierarchy),
        wide_(hierarchy_detail::collapse(hierarchy, object_bounds)),
        visible_(object_bounds.size()),
        rest_(wide_.boxes.size(), 0) {}

  // Appends the objects that may be seen to out, ascending, and adds to the counts of stats. With
  // options.temporal_coherence what was not hidden is not asked about again for a few views (it is kept
  // unless it leaves the view).
  void run(const WalkMaps& maps, const WalkOptions& options, CullStats& stats, std::vector<ObjectId>& out);

  // The next view has nothing to do with the last one.
  void forget() { std::fill(rest_.begin(), rest_.end(), std::uint8_t{0}); }

 private:
  struct Entry {
    std::uint32_t node;
    bool surely_visible;  // with respect to the occluders
  };

  void visit(const Entry& entry, const WalkMaps& maps, const WalkOptions& options, CullStats& stats);
  // Answers for children `begin` to before `end` of the node: past the occluders, or for the view's volume
  // alone.
  void ask(const WalkMaps& maps, const hierarchy_detail::WideNode& node, std::uint32_t begin,
           std::uint32_t end, bool view_only, bool skip_seen);
  void askFineMap(const WalkMaps& maps, const hierarchy_detail::WideNode& node, std::uint32_t begin,
                  std::uint32_t end);
  void keepNode(std::uint32_t node, const BoxAnswer& answer, bool view_only);

  const Hierarchy& hierarchy_;
  hierarchy_detail::WideHierarchy wide_;
  ObjectBits visible_;
  std::vector<Entry> stack_;
  std::vector<BoxAnswer> answers_;  // of the children of one node
  std::vector<Box> asked_again_;
  std::vector<std::uint32_t> asked_child_;
  std::vector<BoxAnswer> second_answers_;
  std::vector<std::uint8_t> rest_;  // by child: so many views it is not asked about
};

}  // namespace sightline::culling_detail
