#pragma once

// The bounds of all parts along the axes. Each frame's search starts at the last frame's farthest vertices
// and goes along edges.
//
// Based on: Snyder, Lengyel. MSR-TR-97-11, section 5.1 and appendix A.
// Differs from the paper in: heights are measured above the eye, or above the first eye for axes fixed to the
// world, so that scenes far from the origin keep their precision; angles are periodic pseudo-angles;
// orthographic views are supported; all bounds are rounded outwards.

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
  // axes: those beyond kMaxExtentAxes are ignored.
  explicit PartExtents(std::vector<ExtentAxis> axes);

  // Brings the table up to date with the view and the parts, and returns how many intervals were computed.
  // Spatial extents fixed to the world are computed only for parts that moved; camera-fixed ones and angles
  // for all parts if the view changed. A part that is not finite gets infinite intervals and the full circle.
  // In an orthographic view, angular axes hold positions across the view, as table().kinds says.
  // moved: one element per part, whether its placement changed since the last call; new parts count as moved.
  // used: one element per part; the extents of the others are left as they are until they are used.
  // more_eyes: of a perspective view; queries then reach to all eyes. Since each eye has angles of its own,
  // angular axes hold positions across the view.
  std::uint64_t update(const View& view, const PartStore& parts, std::span<const std::uint8_t> moved,
                       std::span<const std::uint8_t> used, std::span<const Vec3d> more_eyes = {});

  // Takes a hull anew from the parts. Parts that have it must count as moved in the next update().
  void replaceHull(std::uint32_t hull, const PartStore& parts);

  const ExtentTable& table() const { return table_; }
  // Returns the extent that occluders of a part must overlap: its angles, and its spatial intervals widened
  // to the eye (perspective: to the eye's height along the axis; orthographic: to infinity towards the eye).
  Extent query(std::uint32_t part) const;
  // Returns the united query of the parts of a group, which is not empty.
  Extent query(std::span<const std::uint32_t> group) const;
  // Whether part `front` overlaps the query of part `back`.
  bool mayOcclude(std::uint32_t front, std::uint32_t back) const;

  // The extents of the hulls of parts, one row per instance, and the query of one of them.
  const ExtentTable& hulls() const { return hulls_; }
  Extent queryOfHull(std::uint32_t instance) const { return query(hulls_, std::span(&instance, 1)); }

  // Returns a part's distance from the eye along a spatial axis: the absolute difference of its interval's
  // middle and the eye's height. In an orthographic view it has a sign and grows away from the eye. Infinite
  // if it is not finite.
  double distanceAlong(std::size_t axis, std::uint32_t part) const;

 private:
  std::uint32_t lookFrom(const View& view, std::span<const Vec3d> more_eyes);
  void addParts(const PartStore& parts);
  std::uint32_t rowOf(const ExtentRow& row);
  Extent query(const ExtentTable& table, std::span<const std::uint32_t> group) const;

  std::vector<ExtentAxis> axes_;
  bool has_reference_ = false;
  Vec3d reference_;               // heights along axes fixed to the world are measured above this point
  std::vector<Interval> to_eye_;  // one per axis: eyeHeights()
  std::vector<double> eye_;       // one per axis: the eye's height
  // One per axis: 0 (perspective), or the sign of heights that grow away from the eye (orthographic).
  std::vector<double> away_;

  ExtentUpdate own_;
  std::vector<std::uint32_t> stale_;    // one per part: a bit for each axis whose extent is to be computed
  std::vector<std::uint32_t> axes_of_;  // scratch for update()
  ExtentTable table_, hulls_;
};

}  // namespace sightline::layers
