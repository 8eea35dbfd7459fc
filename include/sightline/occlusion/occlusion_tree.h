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

// The variants of Bittner et al. 1998, table 2 (F: all cull by the view frustum).
// S: the occlusion tree. Faces of boxes are split by its planes; exact with respect to the occluders.
// M: the modified tree. Boxes are classified against its planes and never split, which is conservative; what
// that leaves undecided is settled by the box's image, so that M is as tight as S up to rounding.
// E, C: how a box in the shadow of an occluder is compared with that occluder: exactly, or by its plane.
enum class OcclusionTreeVariant : std::uint8_t { kFSE, kFSC, kFME, kFMC };

struct OcclusionTreeSettings {
  OcclusionTreeVariant variant = OcclusionTreeVariant::kFME;
  bool clip_to_frustum = true;  // what lies outside the view's four side planes counts as hidden
  // A tree with more nodes is built again from the first half of the occluders.
  std::uint32_t max_nodes = 1 << 16;
};

struct OcclusionTreeStats {
  std::uint32_t occluders = 0;  // occluders of all sets whose shadow is in the tree
  std::uint32_t unusable = 0;   // chosen, but seen from behind, edge-on, or wholly before the near plane
  std::uint32_t dropped = 0;    // left out for want of nodes
  std::uint32_t nodes = 0, leaves = 0;  // inner nodes, leaves in shadow
  std::uint32_t depth = 0;              // nodes on the longest path, at most 1,500
  // Counts over all boxes classified since build(): comparisons of a box or of a part of its faces with a
  // plane, and cuts of such parts or of the box's image.
  std::uint64_t plane_tests = 0, cuts = 0;
};

// Tells for any box whether the chosen occluders hide it. It can be used alone: build() from any occluders,
// then classify() boxes at any time. Answers are conservative: kHidden only where no point of the box can be
// seen from the view's eye. Use by one thread at a time; nothing is allocated once the storage has grown to
// what a few builds need. Source: Bittner, Havran, Slavik 1998.
class OcclusionTree {
 public:
  explicit OcclusionTree(const OcclusionTreeSettings& settings = {});
  ~OcclusionTree();
  OcclusionTree(OcclusionTree&&) noexcept;
  OcclusionTree& operator=(OcclusionTree&&) noexcept;

  // Builds the tree of the chosen occluders for a view. The set must outlive the call only.
  void build(const View& view, const OccluderSet& set, std::span<const OccluderId> chosen);
  // Builds from several sets, such as those of a scene and of what moves in it.
  void build(const View& view, std::span<const ChosenOccluders> sets);

  // Classifies a box in scene space as seen from the eye of the last build(). Boxes that are not well formed
  // are kVisible. frustum_planes: bit i is clear where the box is known to be inside plane i of the view's
  // frustum (frustumOf), as classify() of math/frustum.h leaves them; these planes are not tested.
  Visibility classify(const Box& box, std::uint8_t frustum_planes = kAllFrustumPlanes);

  const OcclusionTreeStats& stats() const;
  // The chosen occluders of the first set whose shadow is in the tree.
  std::span<const OccluderId> occluders() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
