#pragma once

// The image of a box as the eye sees it, cut by planes of an occlusion tree one after the other: does any of
// the box reach a region of the tree?

#include <cstdint>
#include <vector>

#include "src/occlusion/eye_box.h"
#include "src/occlusion/tree/polygon_split.h"
#include "src/occlusion/tree/tree_data.h"

namespace sightline::occlusion {

// The image is a convex polygon: the box's outline. Its corners are directions from the eye, unit vectors at
// first; orthographic: points of the outline. It is split as SplittingQuery splits faces, with the same
// tolerances: a side that it reaches by no more than rounding does not get it, for the other side has all of
// it; the parts of the two sides of a shared edge overlap. So every point of the image stays on one side at
// least.
//
// Storage is reused from box to box.
class BoxImage {
 public:
  // No more cuts than this are made. Each adds a rounding of up to 2^-51, at points as near as kNearest; the
  // sum must stay far below kEdgeMargin (docs/conservative.md).
  static constexpr std::uint32_t kMaxCuts = 128;
  // The polygon of directions may come no nearer to the eye than this; it does where they span almost 180
  // degrees. The image of a box that spans more than some 170 degrees is taken as not known, and cuts leave
  // all of it.
  static constexpr double kNearest = 0x1p-4;

  // Starts with the whole image of a box. scale: TreeData::on_plane_scale.
  void begin(const EyeBox& box, const Eye& eye, double scale);

  // The number of cuts so far.
  std::uint32_t cutCount() const { return static_cast<std::uint32_t>(parts_.size()) - 1; }
  // Undoes all cuts after the first `count`.
  void keepCuts(std::uint32_t count);

  // Keeps the part on one side of the node's plane. False: nothing is left.
  bool cut(const TreeNode& node, bool front);

 private:
  void measureDirections();

  // The image after some cuts. The parts of the last split lie on top of the stack.
  struct Part {
    Piece piece;
    std::size_t corners_needed = 0;  // the lowest so many corners of the stack are still in use
  };

  const Eye* eye_ = nullptr;
  double reach_ = 0.0;           // a bound of the length of corners
  double scale_ = 0.0;           // TreeData::on_plane_scale
  double on_plane_scale_ = 0.0;  // see PolygonStack::split
  PolygonStack stack_;
  std::vector<Part> parts_;  // [i]: after i cuts
};

}  // namespace sightline::occlusion
