#pragma once

// The image of a box as the eye sees it, cut by planes of an occlusion tree one after the other: does any of
// the box reach a region of the tree?

#include <cstdint>
#include <vector>

#include "src/occlusion/eye_box.h"
#include "src/occlusion/polygon_split.h"
#include "src/occlusion/tree_data.h"

namespace sightline::occlusion {

// The image is a convex polygon: the box's outline. Its corners are directions from the eye, unit vectors at
// first; orthographic: points of the outline. It is split as SplittingQuery splits faces, with the same
// tolerances: a side that it reaches by no more than rounding does not get it, for the other side has all of
// it; the parts of the two sides of a seam overlap. So every point of the image stays on one side at least.
//
// Storage is reused from box to box.
class BoxImage {
 public:
  // More cuts than this are not made. Rounding adds up to 2^-51 for each of them, at points as near as
  // kNearest, which must stay far below kEdgeMargin (docs/conservative.md).
  static constexpr std::uint32_t kMaxCuts = 128;
  // How near to the eye the polygon of directions may come: 0 where they span 180 degrees. The image of a box
  // that spans more than some 170 degrees is taken as not known, and cuts leave all of it.
  static constexpr double kNearest = 0x1p-4;

  // The whole image. scale: TreeData::on_plane_scale.
  void begin(const EyeBox& box, const Eye& eye, double scale);

  // How many cuts were made.
  std::uint32_t cutCount() const { return static_cast<std::uint32_t>(parts_.size()) - 1; }
  // Forgets those after the first `count`.
  void keepCuts(std::uint32_t count);

  // Keeps what is on one side of the node's plane; false when that is nothing.
  bool cut(const TreeNode& node, bool front);

 private:
  void measureDirections();

  // What is left after so many cuts. The parts of the last split lie on top of the stack.
  struct Part {
    Piece piece;
    std::size_t corners_needed = 0;  // of the stack, from its bottom on
  };

  const Eye* eye_ = nullptr;
  double reach_ = 0.0;           // of a corner, at most
  double scale_ = 0.0;           // of the tree
  double on_plane_scale_ = 0.0;  // see PolygonStack::split
  PolygonStack stack_;
  std::vector<Part> parts_;  // [i]: after i cuts
};

}  // namespace sightline::occlusion
