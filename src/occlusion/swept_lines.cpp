#include "src/occlusion/swept_lines.h"

#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/occlusion/swept_lines.cpp"
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

// Pixels around the buffer in which nothing may be swept either, far above all rounding.
constexpr double kBorder = 1.0;
// A viewer passes what comes nearer to him than this fraction of the clip depth, along the viewing direction.
constexpr double kLeastDepth = 0.02;
constexpr double kRounding = 1e-9;  // relative, far above that of double precision

HWY_INLINE DoublesV set(double v) {
  return hn::Set(kDoubles, v);
}

struct CameraV {
  DoublesV x, y, z;
};

// Whether all points that were added lie on the outer side of a plane through the eye and a side of the
// buffer, farther than the region's radius.
class BeyondSide {
 public:
  // Outside is where sign * (coordinate - slope * z) > 0.
  HWY_INLINE BeyondSide(double slope, double sign, double radius)
      : slope_(set(slope)),
        sign_(set(sign)),
        margin_(set(radius * std::sqrt(1.0 + slope * slope) * (1.0 + kRounding))),
        least_(set(INFINITY)) {}

  HWY_INLINE void add(DoublesV coordinate, DoublesV z) {
    const auto across = hn::Mul(slope_, z);
    const auto rounding = hn::Mul(hn::Add(hn::Abs(coordinate), hn::Abs(across)), set(kRounding));
    least_ = hn::Min(least_, hn::Sub(hn::Mul(sign_, hn::Sub(coordinate, across)), rounding));
  }
  HWY_INLINE DoublesM holds() const { return hn::Gt(least_, margin_); }

 private:
  DoublesV slope_, sign_, margin_, least_;
};

// What the ends of a line are swept to.
class LineSweeps {
 public:
  HWY_INLINE LineSweeps(const PixelView& view, double clip_depth)
      : view_(view),
        least_depth_(set(kLeastDepth * clip_depth)),
        sides_{BeyondSide((view.width + kBorder - view.middle_x) / view.scale_x, 1.0, view.viewers.radius),
               BeyondSide((-kBorder - view.middle_x) / view.scale_x, -1.0, view.viewers.radius),
               BeyondSide((view.height + kBorder - view.middle_y) / view.scale_y, 1.0, view.viewers.radius),
               BeyondSide((-kBorder - view.middle_y) / view.scale_y, -1.0, view.viewers.radius)} {}

  HWY_INLINE void add(const CameraV& from, const CameraV& to) {
    const Place begin = placeOf(from), end = placeOf(to);
    const auto height = hn::Sub(end.y, begin.y), slope = hn::Div(hn::Sub(end.x, begin.x), height);
    // Rounding the ends to the grid changes the slope by no more than this, unless it makes the line level.
    const auto slope_rounding =
        hn::Div(hn::Add(hn::Abs(slope), set(1.0)), hn::Max(hn::Sub(hn::Abs(height), set(1.0)), set(1.0)));
    addEnd(from, begin, slope, slope_rounding);
    addEnd(to, end, slope, slope_rounding);
    // Where the line itself is.
    x_.end(hn::Min(begin.x, end.x), hn::Max(begin.x, end.x));
    y_.end(hn::Min(begin.y, end.y), hn::Max(begin.y, end.y));
  }

  HWY_INLINE void store(GridSweeps& sweeps, std::size_t at) const {
    const auto outside =
        hn::Or(hn::Or(sides_[0].holds(), sides_[1].holds()), hn::Or(sides_[2].holds(), sides_[3].holds()));
    const auto put = [&](DoublesV v, std::vector<double>& to) HWY_ATTR {
      const auto large = set(4.0 * kLargestGrid);
      const auto swept = hn::IfThenElse(hn::Lt(v, large), v, large);  // also where it is no number
      hn::StoreU(hn::IfThenZeroElse(outside, swept), kDoubles, to.data() + at);
    };
    const auto infinite = set(INFINITY);
    put(hn::IfThenElse(passed_, x_.passedLow(), x_.low), sweeps.left);
    put(hn::IfThenElse(passed_, x_.passedHigh(), x_.high), sweeps.right);
    put(hn::IfThenElse(passed_, y_.passedLow(), y_.low), sweeps.down);
    put(hn::IfThenElse(passed_, y_.passedHigh(), y_.high), sweeps.up);
    put(hn::IfThenElse(passed_, infinite, before_), sweeps.before);
    put(hn::IfThenElse(passed_, infinite, behind_), sweeps.behind);
  }

 private:
  // In 256ths of a pixel, from where the forward axis meets the buffer.
  struct Place {
    DoublesV x, y;
  };

  // How far it gets along one axis of the buffer.
  struct Axis {
    HWY_INLINE Axis()
        : low(set(0.0)),
          high(set(0.0)),
          least_right(set(INFINITY)),
          least_left(set(INFINITY)),
          line_low(set(0.0)),
          line_high(set(0.0)) {}

    DoublesV low, high;  // to either side of the line
    // Where it is passed, it goes to infinity on the side of the forward axis on which all of it is: not
    // nearer to the axis than these. Infinite where it may be on both.
    DoublesV least_right, least_left;
    DoublesV line_low, line_high;

    HWY_INLINE void end(DoublesV lower, DoublesV higher) {
      line_low = lower;
      line_high = higher;
    }
    // A corner of what the line is swept over: at `coordinate` and `depth` in camera space.
    HWY_INLINE void corner(DoublesV coordinate, DoublesV depth, double radius, double units) {
      const auto beside = hn::Sub(hn::Abs(coordinate), set(radius * (1.0 + kRounding)));
      const auto before_eye = hn::Add(depth, set(radius));
      const auto place =
          hn::IfThenElse(hn::Gt(before_eye, set(0.0)),
                         hn::Mul(hn::Div(beside, before_eye), set(units * (1.0 - kRounding))), set(INFINITY));
      const auto right = hn::Gt(coordinate, set(0.0)), clear = hn::Gt(beside, set(0.0));
      least_right = hn::Min(least_right, hn::IfThenElse(hn::And(right, clear), place, set(-INFINITY)));
      least_left = hn::Min(least_left, hn::IfThenElse(hn::AndNot(right, clear), place, set(-INFINITY)));
    }
    HWY_INLINE DoublesV passedLow() const {
      return hn::IfThenElse(hn::Gt(least_right, set(0.0)),
                            hn::Max(hn::Add(hn::Sub(line_low, least_right), set(1.0)), set(1.0)),
                            set(INFINITY));
    }
    HWY_INLINE DoublesV passedHigh() const {
      return hn::IfThenElse(hn::Gt(least_left, set(0.0)),
                            hn::Max(hn::Sub(set(1.0), hn::Add(line_high, least_left)), set(1.0)),
                            set(INFINITY));
    }
  };

  HWY_INLINE Place placeOf(const CameraV& point) const {
    const auto inverse = hn::Div(set(1.0), point.z);
    return {hn::Mul(hn::Mul(point.x, inverse), set(view_.scale_x * kGridStep)),
            hn::Mul(hn::Mul(point.y, inverse), set(view_.scale_y * kGridStep))};
  }

  HWY_INLINE void addEnd(const CameraV& end, const Place& at, DoublesV slope, DoublesV slope_rounding) {
    addCorner(end);
    Place low = at, high = at, farthest{hn::Abs(at.x), hn::Abs(at.y)};
    auto before = set(0.0), behind = set(0.0), nearest = end.z;
    for (const Vec3d& offset : view_.viewers.offsets) {
      const CameraV moved{hn::Sub(end.x, set(offset.x)), hn::Sub(end.y, set(offset.y)),
                          hn::Sub(end.z, set(offset.z))};
      const Place to = placeOf(moved);
      addCorner(moved);
      low = {hn::Min(low.x, to.x), hn::Min(low.y, to.y)};
      high = {hn::Max(high.x, to.x), hn::Max(high.y, to.y)};
      farthest = {hn::Max(farthest.x, hn::Abs(to.x)), hn::Max(farthest.y, hn::Abs(to.y))};
      const auto across = hn::Sub(hn::Sub(to.x, at.x), hn::Mul(slope, hn::Sub(to.y, at.y)));
      before = hn::Max(before, hn::Neg(across));
      behind = hn::Max(behind, across);
      nearest = hn::Min(nearest, moved.z);
    }
    const auto radius = set(view_.viewers.radius), depth = hn::Sub(nearest, radius);
    passed_ = hn::Or(passed_, hn::Not(hn::Ge(depth, least_depth_)));
    // The rest of the region is around that. One more for what rounding the ends to the grid may take away.
    const auto around = hn::Div(radius, depth);
    const auto spare = [around](DoublesV farthest_place, double scale) HWY_ATTR {
      const auto ball = hn::Mul(around, hn::Add(set(scale * kGridStep), farthest_place));
      return hn::Add(hn::Add(ball, hn::Mul(farthest_place, set(kRounding))), set(1.0));
    };
    const auto spare_x = spare(farthest.x, view_.scale_x), spare_y = spare(farthest.y, view_.scale_y);
    const auto swept_y = hn::Add(hn::Max(hn::Sub(at.y, low.y), hn::Sub(high.y, at.y)), spare_y);
    const auto spare_across =
        hn::Add(hn::Add(spare_x, hn::Mul(hn::Abs(slope), spare_y)), hn::Mul(slope_rounding, swept_y));
    x_.low = hn::Max(x_.low, hn::Add(hn::Sub(at.x, low.x), spare_x));
    x_.high = hn::Max(x_.high, hn::Add(hn::Sub(high.x, at.x), spare_x));
    y_.low = hn::Max(y_.low, hn::Add(hn::Sub(at.y, low.y), spare_y));
    y_.high = hn::Max(y_.high, hn::Add(hn::Sub(high.y, at.y), spare_y));
    before_ = hn::Max(before_, hn::Add(before, spare_across));
    behind_ = hn::Max(behind_, hn::Add(behind, spare_across));
  }
  HWY_INLINE void addCorner(const CameraV& point) {
    x_.corner(point.x, point.z, view_.viewers.radius, view_.scale_x * kGridStep);
    y_.corner(point.y, point.z, view_.viewers.radius, view_.scale_y * kGridStep);
    sides_[0].add(point.x, point.z);
    sides_[1].add(point.x, point.z);
    sides_[2].add(point.y, point.z);
    sides_[3].add(point.y, point.z);
  }

  const PixelView& view_;
  DoublesV least_depth_;
  BeyondSide sides_[4];
  DoublesM passed_ = hn::Lt(set(0.0), set(0.0));
  Axis x_, y_;
  DoublesV before_ = set(0.0), behind_ = set(0.0);
};

void sweepLines(const PixelView& view, double clip_depth, const SweptLines& lines, std::size_t count,
                GridSweeps& sweeps) {
  const auto load = [](const CameraPoints& points, std::size_t at) HWY_ATTR {
    return CameraV{hn::LoadU(kDoubles, points.x.data() + at), hn::LoadU(kDoubles, points.y.data() + at),
                   hn::LoadU(kDoubles, points.z.data() + at)};
  };
  const LineSweeps none(view, clip_depth);
  for (std::size_t i = 0; i < count; i += hn::Lanes(kDoubles)) {
    LineSweeps line = none;
    line.add(load(lines.from, i), load(lines.to, i));
    line.store(sweeps, i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sightline::occlusion
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::occlusion {

HWY_EXPORT(sweepLines);

void findSweeps(const PixelView& view, double clip_depth, const SweptLines& lines, std::size_t count,
                GridSweeps& sweeps) {
  sweeps.reserve(count);
  HWY_DYNAMIC_DISPATCH(sweepLines)(view, clip_depth, lines, count, sweeps);
}

}  // namespace sightline::occlusion
#endif
