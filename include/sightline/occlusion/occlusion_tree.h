#pragma once

// Occlusion trees: the merged occlusion volumes of a set of occluders, seen from one viewpoint, in a BSP
// tree.

#include <cstdint>
#include <memory>
#include <span>

#include "sightline/math/frustum.h"
#include "sightline/occluders/occluder_set.h"
#include "sightline/occlusion/visibility.h"
#include "sightline/scene/camera.h"

namespace sightline {

// Bittner et al. 1998, table 2 (all with view-frustum culling, F).
// S: the occlusion tree, boxes' faces are split by its planes, exact with respect to the occluders.
// M: the modified tree, boxes are only classified against its planes, never split, conservative; what that
// leaves undecided is settled by the box's image, so that it is as tight as S up to rounding.
// E, C: the test against the occluder where a leaf is in its shadow. Exact, or the box against the occluder's
// plane.
enum class OcclusionTreeVariant : std::uint8_t { kFSE, kFSC, kFME, kFMC };

struct OcclusionTreeSettings {
  OcclusionTreeVariant variant = OcclusionTreeVariant::kFME;
  bool clip_to_frustum = true;  // what lies outside the view's four side planes counts as hidden
  std::uint32_t max_nodes =
      1 << 16;  // with more the tree is built again from the first half of the occluders
};

struct OcclusionTreeStats {
  std::uint32_t occluders = 0;  // of all sets, whose shadow is in the tree
  std::uint32_t unusable = 0;   // chosen, but seen from behind, edge-on, or wholly before the near plane
  std::uint32_t dropped = 0;    // left out for want of nodes
  std::uint32_t nodes = 0, leaves = 0;  // inner nodes, leaves in shadow
  std::uint32_t depth = 0;              // nodes on a path, at most 1,500
  // Counted over all boxes classified since build(): comparisons of a box or of a part of its faces with a
  // plane, and cuts of such parts or of the box's image.
  std::uint64_t plane_tests = 0, cuts = 0;
};

// Usable alone: build() from any occluders, then classify() any box at any time. Answers are conservative:
// kHidden only where no point of the box can be seen from the view's eye. Not safe to share between threads;
// allocates nothing once its storage has grown to what a few builds need.
class OcclusionTree {
 public:
  explicit OcclusionTree(const OcclusionTreeSettings& settings = {});
  ~OcclusionTree();
  OcclusionTree(OcclusionTree&&) noexcept;
  OcclusionTree& operator=(OcclusionTree&&) noexcept;

  // The tree of the chosen occluders for the view. The set must outlive the call only.
  void build(const View& view, const OccluderSet& set, std::span<const OccluderId> chosen);
  // The same of several sets, as of a scene and of what moves in it.
  void build(const View& view, std::span<const ChosenOccluders> sets);

  // Of a box in scene space, as seen from the eye of the last build(). Boxes that are not well formed are
  // kVisible. frustum_planes: bit i is clear where the box is known to be inside plane i of the view's
  // frustum (frustumOf), as classify() of math/frustum.h leaves them; those planes are passed over.
  Visibility classify(const Box& box, std::uint8_t frustum_planes = kAllFrustumPlanes);

  const OcclusionTreeStats& stats() const;
  // Those of the first set's chosen ones whose shadow is in the tree.
  std::span<const OccluderId> occluders() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
