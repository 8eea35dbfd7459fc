#include "layers/part_extents.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "layers/angular_extent.h"
#include "layers/round_outwards.h"
#include "layers/support.h"
#include "sightline/geometry/tolerance.h"

namespace sightline::layers {
namespace {

using Measure = AxisLook::Measure;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr Interval kEndless{-kInfinity, kInfinity};

// Numbers kept for an instance and an axis.
constexpr std::uint32_t kHeightVertices = 2;  // lowest, highest
constexpr std::uint32_t kAngleVertices = 3;   // AngularVertices; heights need the first two

// Computing a point's height or its place in a plane, from an exact placement and direction: 12 operations in
// a row at most, each rounding by 2^-53 of a number that is no greater than `reach`. Frames are perpendicular
// up to their own rounding, and a ray across a direction is so up to 2^-50: as much again.
constexpr double kRounding = 0x1p-48;

}  // namespace

PartExtents::PartExtents(std::vector<ExtentAxis> axes) : axes_(std::move(axes)) {
  axes_.resize(std::min(axes_.size(), kMostExtentAxes));
  for (ExtentAxis& axis : axes_) {
    axis = normalizedAxis(axis);
    first_vertex_.push_back(vertices_of_instance_);
    vertices_of_instance_ += axis.kind == ExtentAxis::Kind::kAngular ? kAngleVertices : kHeightVertices;
  }
  looks_.resize(axes_.size());
  to_eye_.resize(axes_.size());
  eye_.resize(axes_.size());
  away_.resize(axes_.size());
  table_.kinds.resize(axes_.size());
  table_.lows.resize(axes_.size());
  table_.highs.resize(axes_.size());
}

std::uint64_t PartExtents::update(const View& view, const PartStore& parts,
                                  std::span<const std::uint8_t> moved) {
  const std::size_t known = table_.parts;
  const std::uint32_t all = static_cast<std::uint32_t>((std::uint64_t{1} << axes_.size()) - 1);
  const std::uint32_t turned = lookFrom(view);
  addParts(parts);
  std::uint64_t computed = 0;
  for (std::uint32_t part = 0; part < parts.parts(); ++part) {
    const std::uint32_t axes = part >= known || moved[part] != 0 ? all : turned;
    if (axes != 0) {
      updatePart(part, parts, axes);
      computed += static_cast<std::uint64_t>(std::popcount(axes));
    }
  }
  return computed;
}

// Returns the axes whose extents must be taken anew for all parts.
std::uint32_t PartExtents::lookFrom(const View& view) {
  if (!has_reference_ && isFinite(view.eye)) {
    has_reference_ = true;
    reference_ = view.eye;
  }
  std::uint32_t turned = 0;
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    const AxisLook look = lookAlong(axes_[axis], view, reference_);
    turned |= (look == looks_[axis] ? 0u : 1u) << axis;
    looks_[axis] = look;
    to_eye_[axis] = eyeHeights(look, view);
    eye_[axis] = dot(look.direction, view.eye - look.from);
    away_[axis] = !view.orthographic ? 0.0 : std::copysign(1.0, dot(look.direction, view.forward));
    table_.kinds[axis] = look.kind();
  }
  return turned;
}

void PartExtents::addParts(const PartStore& parts) {
  for (std::size_t i = hulls_.size(); i < parts.hulls.size(); ++i) {
    const ConvexHull& hull = parts.hulls[i];
    hulls_.push_back({1.0001 * (length(hull.centre) + hull.radius), 1.0001 * supportError(hull, 1.0)});
  }
  vertices_.resize(parts.instances() * vertices_of_instance_);
  if (table_.parts == parts.parts()) {
    return;
  }
  table_.parts = parts.parts();
  const std::size_t padded =
      (table_.parts + ExtentTable::kPadding - 1) / ExtentTable::kPadding * ExtentTable::kPadding;
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    // Not a number overlaps nothing, not even what is infinite.
    table_.lows[axis].resize(padded);
    table_.highs[axis].resize(padded);
    for (std::size_t i = table_.parts; i < padded; ++i) {
      table_.lows[axis][i] = table_.highs[axis][i] = std::numeric_limits<float>::quiet_NaN();
    }
  }
}

void PartExtents::updatePart(std::uint32_t part, const PartStore& parts, std::uint32_t axes) {
  const bool finite = parts.finite[part] != 0;
  if (finite) {
    const Placement& placement = parts.placements[part];
    const double stretch = stretchOf(placement);
    const std::uint32_t begin = parts.first_hull[part], end = parts.first_hull[part + 1];
    for (std::uint32_t instance = begin; instance < end; ++instance) {
      const std::uint32_t hull = parts.part_hulls[instance];
      addInstance(instance, parts.hulls[hull], hulls_[hull], placement, stretch, axes, instance == begin);
    }
  }
  store(part, axes, finite);
}

void PartExtents::addInstance(std::uint32_t instance, const ConvexHull& hull, const HullBounds& bounds,
                              const Placement& placement, double stretch, std::uint32_t axes, bool first) {
  std::uint32_t* const vertices = vertices_.data() + std::size_t{instance} * vertices_of_instance_;
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    const AxisLook& look = looks_[axis];
    if (((axes >> axis) & 1u) == 0 || look.measure == Measure::kNothing) {
      continue;
    }
    std::uint32_t* const own = vertices + first_vertex_[axis];
    if (look.measure == Measure::kAngles) {
      const AngleRange angles = anglesOf(hull, bounds, placement, stretch, look, own);
      bounds_[axis].angles = first ? angles : unite(bounds_[axis].angles, angles);
    } else {
      const Heights heights = heightsOf(hull, bounds, placement, stretch, look, own);
      Heights& all = bounds_[axis].heights;
      all = first ? heights : Heights{std::min(all.low, heights.low), std::max(all.high, heights.high)};
    }
  }
}

PartExtents::Heights PartExtents::heightsOf(const ConvexHull& hull, const HullBounds& bounds,
                                            const Placement& placement, double stretch, const AxisLook& look,
                                            std::uint32_t* vertices) const {
  const Vec3d offset = placement.origin - look.from;
  const Vec3d direction = placement.toHull(look.direction);
  const Support low = farthest(hull, -direction, vertices[0]), high = farthest(hull, direction, vertices[1]);
  vertices[0] = low.vertex;
  vertices[1] = high.vertex;
  const double base = dot(look.direction, offset);
  const double error = stretch * bounds.error + kRounding * (stretch * bounds.reach + magnitude(offset));
  const Heights heights{base - low.height - error, base + high.height + error};
  return heights.low <= heights.high ? heights : Heights{-kInfinity, kInfinity};
}

AngleRange PartExtents::anglesOf(const ConvexHull& hull, const HullBounds& bounds, const Placement& placement,
                                 double stretch, const AxisLook& look, std::uint32_t* vertices) const {
  const Vec3d offset = placement.origin - look.from;
  PlaneMap map;
  map.x = placement.toHull(look.direction);
  map.z = placement.toHull(look.zero);
  map.origin = {dot(look.direction, offset), dot(look.zero, offset)};
  map.stretch = stretch;
  map.rounding = kRounding * (stretch * bounds.reach + magnitude(offset));
  map.slack = 1.0001 * stretch * hull.slack;
  AngularVertices start{vertices[0], vertices[1], vertices[2]};
  const AngleRange range = angularExtent(hull, map, start);
  vertices[0] = start.low;
  vertices[1] = start.high;
  vertices[2] = start.nearest;
  return range;
}

void PartExtents::store(std::uint32_t part, std::uint32_t axes, bool finite) {
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    if (((axes >> axis) & 1u) == 0) {
      continue;
    }
    const bool angular = looks_[axis].measure == Measure::kAngles;
    Interval interval = angular ? kFullCircle : kEndless;
    if (finite && angular) {
      const AngleRange range = bounds_[axis].angles;
      interval = roundedAngles({range.low - kAngleMargin, range.high + kAngleMargin});
    } else if (finite && looks_[axis].measure == Measure::kHeights) {
      const Heights heights = bounds_[axis].heights;
      interval = {roundedDown(heights.low), roundedUp(heights.high)};
    }
    table_.lows[axis][part] = interval.low;
    table_.highs[axis][part] = interval.high;
  }
}

Extent PartExtents::query(std::uint32_t part) const {
  return query(std::span(&part, 1));
}

Extent PartExtents::query(std::span<const std::uint32_t> members) const {
  Extent extent{};
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    Interval& all = extent[axis];
    all = table_.at(axis, members[0]);
    if (!table_.angular(axis)) {
      for (const std::uint32_t member : members.subspan(1)) {
        all = unite(all, table_.at(axis, member));
      }
      all = unite(all, to_eye_[axis]);
    } else if (members.size() > 1) {
      AngleRange range{all.low, all.high};
      for (const std::uint32_t member : members.subspan(1)) {
        const Interval own = table_.at(axis, member);
        range = unite(range, AngleRange{own.low, own.high});
      }
      all = roundedAngles(range);
    }
  }
  return extent;
}

bool PartExtents::mayOcclude(std::uint32_t front, std::uint32_t back) const {
  for (std::size_t axis = 0; axis < table_.axes(); ++axis) {
    const Interval ahead = table_.at(axis, front), behind = table_.at(axis, back);
    if (table_.angular(axis) ? !overlapsAngular(behind, ahead)
                             : !overlapsSpatial(unite(behind, to_eye_[axis]), ahead)) {
      return false;
    }
  }
  return true;
}

double PartExtents::distanceAlong(std::size_t axis, std::uint32_t part) const {
  const Interval own = table_.at(axis, part);
  const double above_eye = 0.5 * (double{own.low} + double{own.high}) - eye_[axis];
  if (!std::isfinite(above_eye)) {
    return std::numeric_limits<double>::infinity();
  }
  return away_[axis] == 0.0 ? std::abs(above_eye) : above_eye * away_[axis];
}

}  // namespace sightline::layers
