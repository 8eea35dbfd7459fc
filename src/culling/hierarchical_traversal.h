#pragma once

// The traversal of a hierarchy that is common to the methods that test one box at a time.
//
// Based on: Bittner, Havran, Slavik. Hierarchical Visibility Culling with Occlusion Trees. CGI 1998,
// sections 5.3, 5.4; Coorg, Teller. Real-Time Occlusion Culling for Models with Large Occluders. I3D 1997,
// section 4. Differs from the papers in: the objects in partly visible leaves may be tested by their own
// boxes.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/culling/culling_method.h"
#include "sightline/hierarchy/hierarchy.h"
#include "sightline/math/frustum.h"
#include "sightline/occlusion/supporting_planes.h"
#include "src/culling/object_bits.h"
#include "src/culling/set_filter.h"

namespace sightline::culling {

// A box that the traversal tests.
struct TraversalBox {
  const Box& box;
  // Index of the node, or the number of nodes plus an index into Hierarchy::objects.
  std::uint32_t item;
  std::uint8_t frustum_planes;  // bit i is clear if the box is inside of the frustum's plane i
};

// An occlusion structure that the traversal can use has these functions:
//
//   Visibility classify(const TraversalBox&, OccluderList among, OccluderList& touching)
//     Returns the box's state. among: the occluders to test, which are those that touched the parent node, or
//     start() at the root. touching: receives those that touch this box.
//   OccluderList start()
//     Returns the occluders to test at the root.
//   void settled(NodeIndex)
//     Is called when a node was found hidden or visible, so that the traversal does not test below it.
//
// This structure always tests against all occluders.
template <typename Classify>
struct AskAll {
  Classify classify_box;  // TraversalBox -> Visibility

  Visibility classify(const TraversalBox& box, OccluderList, OccluderList&) { return classify_box(box); }
  OccluderList start() const { return {}; }
  void settled(NodeIndex) {}
};
template <typename Classify>
AskAll(Classify) -> AskAll<Classify>;

// A structure that hides nothing: what is left is view-frustum culling.
inline auto seeEverything() {
  return AskAll{[](const TraversalBox&) { return Visibility::kVisible; }};
}

struct TraversalOptions {
  std::uint32_t min_node_cost = 0;
  bool temporal_coherence = true;
  bool test_objects = true;
  // Objects that are not in the filter's set are left out. It needs SetFilter::Marks::kAll; null: no filter.
  const SetFilter* filter = nullptr;
};

class HierarchicalTraversal {
 public:
  HierarchicalTraversal(const Hierarchy& hierarchy, std::span<const Box> object_bounds)
      : hierarchy_(hierarchy),
        object_bounds_(object_bounds),
        visible_(object_bounds.size()),
        decided_(object_bounds.size()),
        partial_(hierarchy.nodes.size(), false) {}

  // Appends the objects that may be visible to out, in ascending order, and adds to the counts of stats.
  template <typename Structure>
  void run(const Frustum& frustum, const TraversalOptions& options, Structure&& structure, CullStats& stats,
           std::vector<ObjectId>& out) {
    stack_.clear();
    if (!hierarchy_.nodes.empty()) {
      stack_.push_back({0, kNoParent, structure.start(), kAllFrustumPlanes, false});
    }
    while (!stack_.empty()) {
      const Entry entry = stack_.back();
      stack_.pop_back();
      visit(entry, frustum, options, structure, stats);
    }
    visible_.drainInto(out);
    decided_.clear();
  }

 private:
  static constexpr std::uint32_t kNoParent = 0xffffffffu;

  struct Entry {
    std::uint32_t node, parent;
    OccluderList occluders;  // the occluders that may hide a part of the node
    std::uint8_t planes;     // bit i is set if the frustum's plane i may cut the node
    bool surely_visible;     // no occluder hides any part of the node
  };

  template <typename Structure>
  void visit(const Entry& entry, const Frustum& frustum, const TraversalOptions& options,
             Structure&& structure, CullStats& stats) {
    if (options.filter != nullptr && !options.filter->hasNode(entry.node)) {
      // The node is not in the set of this view. Nothing is learned about its visibility, nor its parent's.
      partial_[entry.node] = false;
      return;
    }
    const HierarchyNode& node = hierarchy_.nodes[entry.node];
    std::uint8_t planes = entry.planes;
    if (planes != 0) {
      ++stats.nodes_visited;
      if (sightline::classify(frustum, node.bounds, planes) == FrustumSide::kOutside) {
        settle(entry);
        return;
      }
    }
    Visibility state = Visibility::kVisible;
    OccluderList occluders = entry.occluders;
    bool skipped = false;
    if (!entry.surely_visible && node.cost >= options.min_node_cost) {
      // The box of such a node is not bounded, but objects below it may still be hidden.
      const bool unbounded = !node.leaf() && !node.bounds.wellFormed();
      skipped = unbounded || (options.temporal_coherence && !node.leaf() && partial_[entry.node]);
      if (skipped) {
        ++stats.nodes_skipped;
        state = Visibility::kPartial;
      } else {
        ++stats.nodes_tested;
        state = structure.classify({node.bounds, entry.node, planes}, entry.occluders, occluders);
      }
    }
    if (state != Visibility::kPartial) {
      settle(entry);
      structure.settled(NodeIndex(entry.node));
    }
    if (state == Visibility::kHidden) {
      stats.hidden_triangles += node.cost;
      return;
    }
    const bool surely_visible = state == Visibility::kVisible;
    if (surely_visible && planes == 0) {
      for (const ObjectId object : hierarchy_.objectsBelow(NodeIndex(entry.node))) {
        if (passes(object, options)) {
          visible_.insert(object);
        }
      }
    } else if (node.leaf()) {
      keepLeaf(NodeIndex(entry.node), frustum, planes, surely_visible, options, occluders, structure, stats);
    } else {
      if (!surely_visible) {
        partial_[entry.node] = true;
      }
      const std::uint32_t left = entry.node + 1;
      stack_.push_back(
          {hierarchy_.right(NodeIndex(entry.node)).value, entry.node, occluders, planes, surely_visible});
      stack_.push_back({left, entry.node, occluders, planes, surely_visible});
    }
  }

  // Records that the node's state is certain: the node and its parent are tested again in the next frame.
  void settle(const Entry& entry) {
    partial_[entry.node] = false;
    if (entry.parent != kNoParent) {
      partial_[entry.parent] = false;
    }
  }

  static bool passes(ObjectId object, const TraversalOptions& options) {
    return options.filter == nullptr || options.filter->hasObject(object);
  }

  template <typename Structure>
  void keepLeaf(NodeIndex index, const Frustum& frustum, std::uint8_t planes, bool surely_visible,
                const TraversalOptions& options, OccluderList occluders, Structure&& structure,
                CullStats& stats) {
    const bool test_objects = !surely_visible && options.test_objects;
    const HierarchyNode& leaf = hierarchy_.nodes[index.value];
    const std::span<const ObjectId> objects = hierarchy_.objectsBelow(index);
    for (std::uint32_t i = 0; i < objects.size(); ++i) {
      const ObjectId object = objects[i];
      if (!passes(object, options)) {
        continue;
      }
      const Box& box = object_bounds_[object.value];
      const bool is_the_node = box == leaf.bounds;
      if (!is_the_node) {
        // An object in several leaves is tested once, in the first one that is reached. It may extend beyond
        // that leaf, to where other planes of the frustum cut it.
        const bool beyond = hierarchy_.kind == HierarchyKind::kKdTree;
        if (beyond && !decided_.insert(object)) {
          continue;
        }
        std::uint8_t object_planes = beyond ? kAllFrustumPlanes : planes;
        if (object_planes != 0 && sightline::classify(frustum, box, object_planes) == FrustumSide::kOutside) {
          continue;
        }
        if (test_objects) {
          ++stats.objects_tested;
          OccluderList touching;
          const auto item = static_cast<std::uint32_t>(hierarchy_.nodes.size() + leaf.link + i);
          if (structure.classify({box, item, object_planes}, occluders, touching) == Visibility::kHidden) {
            stats.hidden_triangles += leaf.cost / objects.size();
            continue;
          }
        }
      }
      visible_.insert(object);
    }
  }

  const Hierarchy& hierarchy_;
  std::span<const Box> object_bounds_;
  ObjectBits visible_, decided_;
  // By node: it was partly visible, and no child has been found hidden or visible since. It need not be
  // tested.
  std::vector<bool> partial_;
  std::vector<Entry> stack_;
};

}  // namespace sightline::culling
