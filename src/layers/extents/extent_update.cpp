#include "src/layers/extents/extent_update.h"

#include <algorithm>
#include <array>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/layers/extents/extent_update.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "sightline/geometry/tolerance.h"
#include "src/layers/extents/angular_extent-inl.h"
#include "src/layers/extents/round_outwards.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::layers::HWY_NAMESPACE {

using Measure = AxisLook::Measure;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr Interval kEndless{-kInfinity, kInfinity};

// Relative error of a point's height or its place in a plane, from an exact placement and direction: at most
// 12 operations in a row, each of which rounds by 2^-53 of a number no greater than `reach`. Frames are
// perpendicular up to their own rounding, and rays across a direction up to 2^-50, which adds as much again.
constexpr double kRounding = 0x1p-48;

// One hull of a part, with the rows in its space.
struct PlacedHull {
  const ConvexHull& hull;
  const HullBounds& bounds;
  double stretch = 1.0;
  const PlacedRow* rows;
};

HWY_INLINE void measureHeights(const PlacedHull& placed, const MeasuredAxis& axis, std::uint32_t* vertices,
                               PartBounds& bounds) {
  const PlacedRow& row = placed.rows[axis.along];
  const Support low = farthestHere(placed.hull, -row.direction, vertices[0]);
  const Support high = farthestHere(placed.hull, row.direction, vertices[1]);
  vertices[0] = low.vertex;
  vertices[1] = high.vertex;
  const double error =
      placed.stretch * placed.bounds.error + kRounding * (placed.stretch * placed.bounds.reach + row.offset);
  double lower = row.base - low.height - error, upper = row.base + high.height + error;
  if (!(lower <= upper)) {
    lower = -kInfinity, upper = kInfinity;
  }
  bounds.low = lower;
  bounds.high = upper;
}

HWY_INLINE AngleRange anglesOf(const PlacedHull& placed, const MeasuredAxis& axis, std::uint32_t* vertices) {
  const PlacedRow &x = placed.rows[axis.along], &z = placed.rows[axis.zero];
  PlaneMap map;
  map.x = x.direction;
  map.z = z.direction;
  map.origin = {x.base, z.base};
  map.stretch = placed.stretch;
  map.rounding = kRounding * (placed.stretch * placed.bounds.reach + x.offset);
  map.slack = 1.0001 * placed.stretch * placed.hull.slack;
  AngularVertices start{vertices[0], vertices[1], vertices[2]};
  const AngleRange range = angularExtentHere(placed.hull, map, start);
  vertices[0] = start.low;
  vertices[1] = start.high;
  vertices[2] = start.nearest;
  return range;
}

HWY_INLINE void measureHull(const PlacedHull& placed, const ExtentUpdate& update, std::uint32_t axes,
                            std::uint32_t* vertices, PartBounds* bounds) {
  for (std::size_t i = 0; i < update.axes.size(); ++i) {
    const MeasuredAxis& axis = update.axes[i];
    if (((axes >> i) & 1u) == 0 || axis.look.measure == Measure::kNothing) {
      continue;
    }
    std::uint32_t* const own = vertices + axis.first_vertex;
    if (axis.look.measure == Measure::kAngles) {
      bounds[i].angles = anglesOf(placed, axis, own);
    } else {
      measureHeights(placed, axis, own, bounds[i]);
    }
  }
}

HWY_INLINE void uniteBounds(const ExtentUpdate& update, std::uint32_t axes, const PartBounds* other,
                            PartBounds* bounds) {
  for (std::size_t i = 0; i < update.axes.size(); ++i) {
    if (((axes >> i) & 1u) == 0) {
      continue;
    }
    bounds[i].low = std::min(bounds[i].low, other[i].low);
    bounds[i].high = std::max(bounds[i].high, other[i].high);
    if (update.axes[i].look.measure == Measure::kAngles) {
      bounds[i].angles = unite(bounds[i].angles, other[i].angles);
    }
  }
}

HWY_INLINE Interval intervalOf(const MeasuredAxis& axis, const PartBounds& bounds, bool finite) {
  const bool angular = axis.look.measure == Measure::kAngles;
  if (!finite || axis.look.measure == Measure::kNothing) {
    return angular ? kFullCircle : kEndless;
  }
  if (angular) {
    return roundedAngles({bounds.angles.low - kAngleMargin, bounds.angles.high + kAngleMargin});
  }
  return {roundedDown(bounds.low), roundedUp(bounds.high)};
}

HWY_INLINE void writeBounds(const ExtentUpdate& update, std::uint32_t axes, const PartBounds* bounds,
                            bool finite, std::uint32_t row, ExtentTable& table) {
  for (std::size_t i = 0; i < update.axes.size(); ++i) {
    if (((axes >> i) & 1u) != 0) {
      const Interval interval = intervalOf(update.axes[i], bounds[i], finite);
      table.lows[i][row] = interval.low;
      table.highs[i][row] = interval.high;
    }
  }
}

HWY_INLINE void updatePart(ExtentUpdate& update, const PartStore& parts, std::uint32_t part,
                           std::uint32_t axes, ExtentTable& table, ExtentTable& hulls) {
  PartBounds* const all = update.part_bounds.data();
  const bool finite = parts.finite[part] != 0;
  const Placement& placement = parts.placements[part];
  PlacedRow* const rows = update.placed_rows.data();
  for (std::size_t i = 0; finite && i < update.rows.size(); ++i) {
    const Vec3d offset = placement.origin - update.rows[i].from;
    const Vec3d& direction = update.rows[i].direction;
    rows[i] = {placement.toHull(direction), dot(direction, offset), l1Norm(offset)};
  }
  const double stretch = stretchOf(placement);
  const std::uint32_t begin = parts.first_hull[part], end = parts.first_hull[part + 1];
  for (std::uint32_t instance = begin; instance < end; ++instance) {
    PartBounds* const own = instance == begin ? all : update.hull_bounds.data();
    if (finite) {
      const std::uint32_t hull = parts.part_hulls[instance];
      measureHull({parts.hulls[hull], update.hulls[hull], stretch, rows}, update, axes,
                  update.vertices.data() + std::size_t{instance} * update.vertices_of_instance, own);
    }
    writeBounds(update, axes, own, finite, instance, hulls);
    if (finite && instance != begin) {
      uniteBounds(update, axes, own, all);
    }
  }
  writeBounds(update, axes, all, finite, part, table);
}

void updateAll(ExtentUpdate& update, const PartStore& parts, std::span<const std::uint32_t> axes_of,
               ExtentTable& table, ExtentTable& hulls) {
  for (std::uint32_t part = 0; part < axes_of.size(); ++part) {
    if (axes_of[part] != 0) {
      updatePart(update, parts, part, axes_of[part], table, hulls);
    }
  }
}

}  // namespace sightline::layers::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::layers {

HWY_EXPORT(updateAll);

void updateExtents(ExtentUpdate& update, const PartStore& parts, std::span<const std::uint32_t> axes_of,
                   ExtentTable& table, ExtentTable& hulls) {
  HWY_DYNAMIC_DISPATCH(updateAll)(update, parts, axes_of, table, hulls);
}

HullBounds boundsOf(const ConvexHull& hull) {
  return {1.0001 * (length(hull.centre) + hull.radius), 1.0001 * supportError(hull, 1.0)};
}

}  // namespace sightline::layers
#endif
