#include "src/layers/extents/part_extents.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace sightline::layers {
PartExtents::PartExtents(std::vector<ExtentAxis> axes) : axes_(std::move(axes)) {
  axes_.resize(std::min(axes_.size(), kMaxExtentAxes));
  for (ExtentAxis& axis : axes_) {
    axis = normalizedAxis(axis);
    own_.axes.push_back({.first_vertex = own_.vertices_of_instance});
    own_.vertices_of_instance += axis.kind == ExtentAxis::Kind::kAngular ? kAngleVertices : kHeightVertices;
  }
  to_eye_.resize(axes_.size());
  eye_.resize(axes_.size());
  away_.resize(axes_.size());
  for (ExtentTable* const table : {&table_, &hulls_}) {
    table->kinds.resize(axes_.size());
    table->lows.resize(axes_.size());
    table->highs.resize(axes_.size());
  }
}

std::uint64_t PartExtents::update(const View& view, const PartStore& parts,
                                  std::span<const std::uint8_t> moved, std::span<const std::uint8_t> used,
                                  std::span<const Vec3d> more_eyes) {
  const std::uint32_t all = static_cast<std::uint32_t>((std::uint64_t{1} << axes_.size()) - 1);
  const std::uint32_t turned = lookFrom(view, view.orthographic ? std::span<const Vec3d>() : more_eyes);
  addParts(parts);
  stale_.resize(parts.parts(), all);
  axes_of_.resize(parts.parts());
  std::uint64_t computed = 0;
  for (std::uint32_t part = 0; part < parts.parts(); ++part) {
    stale_[part] |= moved[part] != 0 ? all : turned;
    axes_of_[part] = used[part] != 0 ? std::exchange(stale_[part], 0u) : 0u;
    computed += static_cast<std::uint64_t>(std::popcount(axes_of_[part]));
  }
  updateExtents(own_, parts, axes_of_, table_, hulls_);
  return computed;
}

// Measures all axes for the view. Returns a bit for each axis whose extents must be recomputed for all parts.
std::uint32_t PartExtents::lookFrom(const View& view, std::span<const Vec3d> more_eyes) {
  if (!has_reference_ && isFinite(view.eye)) {
    has_reference_ = true;
    reference_ = view.eye;
  }
  std::uint32_t turned = 0;
  own_.rows.clear();
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    MeasuredAxis& own = own_.axes[axis];
    AxisLook look = lookAlong(axes_[axis], view, reference_);
    if (!more_eyes.empty() && look.measure == AxisLook::Measure::kAngles) {
      look.measure = AxisLook::Measure::kHeights;
      look.zero = {};
    }
    turned |= (look == own.look ? 0u : 1u) << axis;
    own.look = look;
    own.along = rowOf({look.direction, look.from});
    own.zero = look.measure == AxisLook::Measure::kAngles ? rowOf({look.zero, look.from}) : 0;
    to_eye_[axis] = eyeHeights(look, view);
    View other = view;
    for (const Vec3d& eye : more_eyes) {
      other.eye = eye;
      to_eye_[axis] = unite(to_eye_[axis], eyeHeights(look, other));
    }
    eye_[axis] = dot(look.direction, view.eye - look.from);
    away_[axis] = !view.orthographic ? 0.0 : std::copysign(1.0, dot(look.direction, view.forward));
    table_.kinds[axis] = hulls_.kinds[axis] = look.kind();
  }
  return turned;
}

std::uint32_t PartExtents::rowOf(const ExtentRow& row) {
  const auto found = std::find(own_.rows.begin(), own_.rows.end(), row);
  if (found == own_.rows.end()) {
    own_.rows.push_back(row);
    return static_cast<std::uint32_t>(own_.rows.size() - 1);
  }
  return static_cast<std::uint32_t>(found - own_.rows.begin());
}

namespace {

// NaN in the padding overlaps nothing, not even an infinite interval.
void resize(ExtentTable& table, std::size_t rows) {
  if (table.parts == rows) {
    return;
  }
  table.parts = rows;
  const std::size_t padded =
      (rows + ExtentTable::kPadding - 1) / ExtentTable::kPadding * ExtentTable::kPadding;
  for (std::size_t axis = 0; axis < table.axes(); ++axis) {
    table.lows[axis].resize(padded);
    table.highs[axis].resize(padded);
    for (std::size_t i = rows; i < padded; ++i) {
      table.lows[axis][i] = table.highs[axis][i] = std::numeric_limits<float>::quiet_NaN();
    }
  }
}

}  // namespace

void PartExtents::addParts(const PartStore& parts) {
  for (std::size_t i = own_.hulls.size(); i < parts.hulls.size(); ++i) {
    own_.hulls.push_back(boundsOf(parts.hulls[i]));
  }
  own_.vertices.resize(parts.instances() * own_.vertices_of_instance);
  resize(table_, parts.parts());
  resize(hulls_, parts.instances());
}

void PartExtents::replaceHull(std::uint32_t hull, const PartStore& parts) {
  if (hull < own_.hulls.size()) {
    own_.hulls[hull] = boundsOf(parts.hulls[hull]);
  }
}

Extent PartExtents::query(std::uint32_t part) const {
  return query(std::span(&part, 1));
}

Extent PartExtents::query(std::span<const std::uint32_t> group) const {
  return query(table_, group);
}

Extent PartExtents::query(const ExtentTable& table, std::span<const std::uint32_t> group) const {
  Extent extent{};
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    Interval& all = extent[axis];
    all = table.at(axis, group[0]);
    if (!table.angular(axis)) {
      for (const std::uint32_t member : group.subspan(1)) {
        all = unite(all, table.at(axis, member));
      }
      all = unite(all, to_eye_[axis]);
    } else if (group.size() > 1) {
      AngleRange range{all.low, all.high};
      for (const std::uint32_t member : group.subspan(1)) {
        const Interval own = table.at(axis, member);
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
