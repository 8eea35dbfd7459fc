#pragma once

// A traversal of a hierarchy by an occlusion tree that keeps what it did at each node, for pictures of it.

#include <cstdint>
#include <memory>
#include <span>

#include "sightline/hierarchy/hierarchy.h"
#include "sightline/occluders/occluder_set.h"
#include "sightline/scene/camera.h"

namespace sightline {

// What a frame's traversal did at a node (Bittner et al. 1998, sections 5.3 and 5.4).
enum class NodeVisit : std::uint8_t {
  kNone,     // not reached: the traversal ended above, or the node lies outside the frustum
  kHidden,   // tested and hidden: the traversal ended here
  kVisible,  // tested and visible: all below it is kept
  kPartial,  // tested and partly visible
  kSkipped,  // partly visible in an earlier frame and not tested in this one
};

struct RecordedTraversalSettings {
  std::uint32_t min_node_cost = 0;  // see CullerSettings
  bool temporal_coherence = true;
};

// The traversal of `occlusionTree()`, variant FME. It keeps its marks from frame to frame. Objects are not
// tested by their own boxes.
class RecordedTraversal {
 public:
  // Both outlive it. object_bounds: those of which the hierarchy was built.
  RecordedTraversal(const Hierarchy& hierarchy, std::span<const Box> object_bounds,
                    const RecordedTraversalSettings& settings = {});
  ~RecordedTraversal();
  RecordedTraversal(RecordedTraversal&&) noexcept;
  RecordedTraversal& operator=(RecordedTraversal&&) noexcept;

  // One frame. Returns one entry for each node, valid until the next call.
  std::span<const NodeVisit> traverse(const View& view, const OccluderSet& set,
                                      std::span<const OccluderId> chosen);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
