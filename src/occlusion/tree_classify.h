#pragma once

#include "occlusion/eye_box.h"
#include "occlusion/tree_data.h"
#include "sightline/occlusion/visibility.h"

namespace sightline::occlusion_detail {

// The states of Visibility, and one more for parts outside the frustum, which do not count.
enum class State : std::uint8_t { kHidden, kPartial, kVisible, kNothing };

constexpr State combine(State a, State b) {
  return a == State::kNothing ? b : b == State::kNothing || a == b ? a : State::kPartial;
}

// The standard algorithm (sections 5.1, 5.2): the faces of the box that face the eye are split by the tree's
// planes.
class SplittingQuery {
 public:
  // exact: fragments against the occluder's plane in a leaf; else the whole box.
  State classify(const TreeData& tree, const EyeBox& box, bool exact);

 private:
  State polygon(Link link, Piece piece);
  State node(const TreeNode& node, Piece piece);
  static Piece part(const SplitResult& split, Piece whole, bool front);
  State bothSides(const TreeNode& node, Piece front, Piece back);
  State leaf(const ShadowLeaf& leaf, Piece piece) const;

  const TreeData* tree_ = nullptr;
  const EyeBox* box_ = nullptr;
  bool exact_ = true;
  double reach_ = 0.0;           // largest magnitude in the box
  double on_plane_scale_ = 0.0;  // smallest, and the tree's
  PolygonStack stack_;
};

// The modified algorithm (section 6.2): the box is only put before or behind the tree's planes.
// exact: in a leaf whose occluder's plane the box crosses, the box against the fragment's pyramid.
State classifyByPlanes(const TreeData& tree, const EyeBox& box, bool exact);

// A whole box against the plane of a leaf's occluder: hidden only when all of it lies behind.
State boxBehindSupport(const OcclusionVolume& volume, const EyeBox& box);

// Whether the box has no point in the pyramid from the eye to the fragment (orthographic: the prism from the
// camera's plane). True is certain; near ties are false.
bool disjointFromPyramid(const TreeData& tree, const ShadowLeaf& leaf, const EyeBox& box);

}  // namespace sightline::occlusion_detail
