#include "src/occlusion/surfaces/swept_lines.h"

#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/occlusion/surfaces/swept_lines.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::occlusion {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// A line in each lane.
using Doubles = hn::CappedTag<double, kMostLanes>;
using DoublesV = hn::Vec<Doubles>;
using DoublesM = hn::Mask<Doubles>;
inline constexpr Doubles kDoubles;

constexpr double kInfinity = GridSweeps::kInfinite;
// Pixels around the buffer in which nothing may be swept either, far above all rounding.
constexpr double kBorder = 1.0;
// A viewer may pass what comes nearer to him than this fraction of the clip depth, along the viewing
// direction.
constexpr double kLeastDepth = 0.02;
constexpr double kRounding = 1e-9;  // relative, far above that of double precision

HWY_INLINE DoublesV set(double v) {
  return hn::Set(kDoubles, v);
}
HWY_INLINE DoublesV load(const std::vector<double>& list, std::size_t at) {
  return hn::LoadU(kDoubles, list.data() + at);
}

struct CameraV {
  DoublesV x, y, z;
};
// In 256ths of a pixel of the buffer.
struct PlaceV {
  DoublesV x, y;
};

// Whether all points that were added lie on the outer side of a plane through the eye and a side of the
// buffer, farther from it than the region's radius.
class BeyondSide {
 public:
  // The outer side is where sign * (coordinate - slope * z) > 0.
  HWY_INLINE BeyondSide(double slope, double sign, double radius)
      : slope_(set(slope)),
        sign_(set(sign)),
        margin_(set(radius * std::sqrt(1.0 + slope * slope) * (1.0 + kRounding))),
        least_(set(kInfinity)) {}

  HWY_INLINE void add(DoublesV coordinate, DoublesV z) {
    const auto across = hn::Mul(slope_, z);
    const auto rounding = hn::Mul(hn::Add(hn::Abs(coordinate), hn::Abs(across)), set(kRounding));
    least_ = hn::Min(least_, hn::Sub(hn::Mul(sign_, hn::Sub(coordinate, across)), rounding));
  }
  HWY_INLINE DoublesM holds() const { return hn::Gt(least_, margin_); }

 private:
  DoublesV slope_, sign_, margin_, least_;
};

// Between which places along one axis of the buffer all lies that a line is swept over.
class AxisReach {
 public:
  // scale: pixels to a slope of 1. middle: where the forward axis meets the buffer, pixels.
  HWY_INLINE AxisReach(double scale, double middle, double radius)
      : scale_(scale * kGridStep),
        middle_(middle * kGridStep),
        radius_(radius * (1.0 + kRounding)),
        low_(set(kInfinity)),
        high_(set(-kInfinity)),
        least_right_(low_),
        least_left_(low_) {}

  HWY_INLINE DoublesV placeOf(DoublesV coordinate, DoublesV z) const {
    return hn::Add(set(middle_), hn::Mul(hn::Div(coordinate, z), set(scale_)));
  }
  // How far a place may move if its point moves by the region's radius, which is so many times the depth; and
  // rounding.
  HWY_INLINE DoublesV around(DoublesV place, DoublesV radii) const {
    const auto beside = hn::Abs(hn::Sub(place, set(middle_)));
    const auto rounding = hn::Mul(hn::Add(beside, set(std::abs(middle_))), set(kRounding));
    return hn::Add(hn::Mul(radii, hn::Add(set(scale_), beside)), hn::Add(rounding, set(1.0)));
  }
  // Adds a place to which an end of the line is moved.
  HWY_INLINE void add(DoublesV place, DoublesV spare) {
    low_ = hn::Min(low_, hn::Sub(place, spare));
    high_ = hn::Max(high_, hn::Add(place, spare));
  }
  // Adds the point itself, for lines that are passed. What passes a viewer goes to infinity, on one side of
  // the forward axis if all that is added lies there; then it does not come nearer to the axis than the
  // nearest place of what lies before the eye.
  HWY_INLINE void addPassing(DoublesV coordinate, DoublesV z) {
    const auto beside = hn::Sub(hn::Abs(coordinate), set(radius_)), depth = hn::Add(z, set(radius_));
    const auto from_axis =
        hn::IfThenElse(hn::Gt(depth, set(0.0)),
                       hn::Mul(hn::Div(beside, depth), set(scale_ * (1.0 - kRounding))), set(kInfinity));
    const auto right = hn::Gt(coordinate, set(0.0)), clear = hn::Gt(beside, set(0.0));
    const auto nowhere = set(-kInfinity);
    least_right_ = hn::Min(least_right_, hn::IfThenElse(hn::And(right, clear), from_axis, nowhere));
    least_left_ = hn::Min(least_left_, hn::IfThenElse(hn::AndNot(right, clear), from_axis, nowhere));
  }
  HWY_INLINE DoublesV low(DoublesM passed) const {
    const auto beside = hn::IfThenElse(hn::Gt(least_right_, set(0.0)),
                                       hn::Add(set(middle_ - 1.0), least_right_), set(-kInfinity));
    return hn::IfThenElse(passed, beside, low_);
  }
  HWY_INLINE DoublesV high(DoublesM passed) const {
    const auto beside = hn::IfThenElse(hn::Gt(least_left_, set(0.0)),
                                       hn::Sub(set(middle_ + 1.0), least_left_), set(kInfinity));
    return hn::IfThenElse(passed, beside, high_);
  }

 private:
  double scale_, middle_, radius_;
  DoublesV low_, high_;
  DoublesV least_right_, least_left_;  // distances from the axis
};

// What lines are swept over, by line in each lane.
class Sweep {
 public:
  HWY_INLINE Sweep(const scene::PixelView& view, double clip_depth)
      : view_(view),
        least_depth_(set(kLeastDepth * clip_depth)),
        sides_{side((view.width + kBorder - view.middle_x) / view.scale_x, 1.0),
               side((-kBorder - view.middle_x) / view.scale_x, -1.0),
               side((view.height + kBorder - view.middle_y) / view.scale_y, 1.0),
               side((-kBorder - view.middle_y) / view.scale_y, -1.0)},
        x_(view.scale_x, view.middle_x, view.viewers.radius),
        y_(view.scale_y, view.middle_y, view.viewers.radius),
        passed_(hn::Lt(set(0.0), set(0.0))),
        left_of_line_(set(0.0)),
        right_of_line_(set(0.0)) {}

  // Adds an end of the lines. image: its place as it was rounded. slope: of the lines, x by y.
  HWY_INLINE void add(const CameraV& end, const PlaceV& image, DoublesV slope) {
    addCorner(end, image, slope);
    for (const Vec3d& offset : view_.viewers.offsets) {
      addCorner({hn::Sub(end.x, set(offset.x)), hn::Sub(end.y, set(offset.y)), hn::Sub(end.z, set(offset.z))},
                image, slope);
    }
  }

  // from, to: the images of the ends.
  HWY_INLINE void store(const PlaceV& from, const PlaceV& to, GridSweeps& sweeps, std::size_t at) const {
    const auto outside =
        hn::Or(hn::Or(sides_[0].holds(), sides_[1].holds()), hn::Or(sides_[2].holds(), sides_[3].holds()));
    const auto put = [&](DoublesV v, std::vector<double>& list) HWY_ATTR {
      const auto bounded = hn::IfThenElse(hn::Lt(v, set(kInfinity)), v, set(kInfinity));  // also if it is NaN
      hn::StoreU(hn::IfThenZeroElse(outside, hn::Max(bounded, set(0.0))), kDoubles, list.data() + at);
    };
    put(hn::Sub(hn::Min(from.x, to.x), x_.low(passed_)), sweeps.left);
    put(hn::Sub(x_.high(passed_), hn::Max(from.x, to.x)), sweeps.right);
    put(hn::Sub(hn::Min(from.y, to.y), y_.low(passed_)), sweeps.down);
    put(hn::Sub(y_.high(passed_), hn::Max(from.y, to.y)), sweeps.up);
    put(hn::IfThenElse(passed_, set(kInfinity), left_of_line_), sweeps.left_of_line);
    put(hn::IfThenElse(passed_, set(kInfinity), right_of_line_), sweeps.right_of_line);
  }

 private:
  HWY_INLINE BeyondSide side(double slope, double sign) const {
    return BeyondSide(slope, sign, view_.viewers.radius);
  }
  // Adds a point to which an end is moved.
  HWY_INLINE void addCorner(const CameraV& point, const PlaceV& image, DoublesV slope) {
    sides_[0].add(point.x, point.z);
    sides_[1].add(point.x, point.z);
    sides_[2].add(point.y, point.z);
    sides_[3].add(point.y, point.z);
    x_.addPassing(point.x, point.z);
    y_.addPassing(point.y, point.z);
    // Nothing around the point is nearer than this.
    const auto nearest = hn::Sub(point.z, set(view_.viewers.radius));
    passed_ = hn::Or(passed_, hn::Not(hn::Ge(nearest, least_depth_)));
    const auto radii = hn::Div(set(view_.viewers.radius), nearest);
    const PlaceV at{x_.placeOf(point.x, point.z), y_.placeOf(point.y, point.z)};
    const auto spare_x = x_.around(at.x, radii), spare_y = y_.around(at.y, radii);
    x_.add(at.x, spare_x);
    y_.add(at.y, spare_y);
    const auto right_of_line = hn::Sub(hn::Sub(at.x, image.x), hn::Mul(slope, hn::Sub(at.y, image.y)));
    const auto spare = hn::Add(spare_x, hn::Mul(hn::Abs(slope), spare_y));
    left_of_line_ = hn::Max(left_of_line_, hn::Sub(spare, right_of_line));
    right_of_line_ = hn::Max(right_of_line_, hn::Add(spare, right_of_line));
  }

  const scene::PixelView& view_;
  DoublesV least_depth_;
  BeyondSide sides_[4];
  AxisReach x_, y_;
  DoublesM passed_;
  DoublesV left_of_line_, right_of_line_;
};

void sweepLines(const scene::PixelView& view, double clip_depth, const CameraLines& lines,
                const GridLines& grid, std::size_t count, GridSweeps& sweeps) {
  const auto pointsFrom = [](const CameraPoints& points, std::size_t at) HWY_ATTR {
    return CameraV{load(points.x, at), load(points.y, at), load(points.z, at)};
  };
  const Sweep nothing(view, clip_depth);
  for (std::size_t i = 0; i < count; i += hn::Lanes(kDoubles)) {
    const PlaceV from{load(grid.from_x, i), load(grid.from_y, i)}, to{load(grid.to_x, i), load(grid.to_y, i)};
    const auto height = hn::Sub(to.y, from.y);
    const auto slope = hn::IfThenZeroElse(hn::Eq(height, set(0.0)), hn::Div(hn::Sub(to.x, from.x), height));
    Sweep sweep = nothing;
    sweep.add(pointsFrom(lines.from, i), from, slope);
    sweep.add(pointsFrom(lines.to, i), to, slope);
    sweep.store(from, to, sweeps, i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sightline::occlusion
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::occlusion {

HWY_EXPORT(sweepLines);

void findSweeps(const scene::PixelView& view, double clip_depth, const CameraLines& lines,
                const GridLines& grid, std::size_t count, GridSweeps& sweeps) {
  sweeps.reserve(count);
  HWY_DYNAMIC_DISPATCH(sweepLines)(view, clip_depth, lines, grid, count, sweeps);
}

}  // namespace sightline::occlusion
#endif
