#pragma once

// Bounds of all parts along the axes, followed from frame to frame by walking from the last farthest vertices
// along edges.
//
// Based on: Snyder, Lengyel. MSR-TR-97-11, section 5.1 and appendix A.
// Differs from the paper in: heights are above the eye, or above the first eye for axes that are fixed to the
// world, so that scenes far from the origin keep their precision; angles are periodic pseudo-angles; of
// orthographic views too; everything is rounded outwards.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/layers/extent_axis.h"
#include "sightline/scene/camera.h"
#include "src/layers/extents/extent_table.h"
#include "src/layers/extents/extent_update.h"
#include "src/layers/extents/plane_angle.h"
#include "src/layers/pairs/part_store.h"

namespace sightline::layers {

class PartExtents {
 public:
  // axes: at most kMaxExtentAxes; what is beyond is left out.
  explicit PartExtents(std::vector<ExtentAxis> axes);

  // Brings the table up to date with the view and the parts. moved: one a part, whether its placement changed
  // since the last call; parts that are new count as moved. World-fixed spatial extents are computed for
  // those alone, camera-fixed ones and angles for all if the view changed. A part that is not finite has
  // infinite extents and the full circle. Returns how many intervals were computed. Angular axes of an
  // orthographic view hold positions across the view: table().kinds says so.
  std::uint64_t update(const View& view, const PartStore& parts, std::span<const std::uint8_t> moved);

  const ExtentTable& table() const { return table_; }
  // What occluders of a part must overlap: its spatial intervals widened to the eye (perspective: to the
  // eye's height along the axis; orthographic: without end towards the eye), its angles as they are.
  Extent query(std::uint32_t part) const;
  // The same for parts taken together. members: at least one.
  Extent query(std::span<const std::uint32_t> members) const;
  // Whether a part overlaps another one's query.
  bool mayOcclude(std::uint32_t front, std::uint32_t back) const;
  // Of an axis: the middle of a part's interval less the eye's height, absolute: what orders parts by
  // distance. Orthographic: with its sign, growing away from the eye. Not finite: infinite. axis: spatial.
  double distanceAlong(std::size_t axis, std::uint32_t part) const;

 private:
  std::uint32_t lookFrom(const View& view);
  void addParts(const PartStore& parts);
  std::uint32_t rowOf(const ExtentRow& row);

  std::vector<ExtentAxis> axes_;
  bool has_reference_ = false;
  Vec3d reference_;               // world-fixed heights are above it
  std::vector<Interval> to_eye_;  // an axis: see eyeHeights()
  std::vector<double> eye_;       // an axis: the eye's height
  std::vector<double> away_;  // an axis: 0, or of orthographic views the sign of heights away from the eye

  ExtentUpdate own_;
  std::vector<std::uint32_t> axes_of_;  // scratch
  ExtentTable table_;
};

}  // namespace sightline::layers
