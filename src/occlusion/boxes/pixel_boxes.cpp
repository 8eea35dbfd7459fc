// Images of boxes and points, in single precision with bounds for all rounding.
//
// Let u = 2^-24, and S the sum of the largest magnitudes of a box's coordinates relative to the eye.
//
//   d = (corner - eye_high) - eye_low   off by 2 u |d| + eye_rounding: where the first difference is smaller
//                                       than half of eye_high it is exact
//   c = axis . d                        off by E = 6 u S + 3 eye_rounding: 2 u of d, u of the axis, u of the
//                                       products, 2 u of the sums. With what follows kRounding = 10 u is used
//   q = c.x / c.z                       off by r (1 + |q|), r = E / (z - E); made 1/16 larger for its own
//                                       square, and 8 u for division and product
//   X = middle + scale q                off by another 8 u (|middle| + scale |q|)
//
// The bound of q grows more slowly than q itself, so that the extremes over the corners give those of the
// bounds too. A point is a box with one corner.

#include "src/occlusion/boxes/pixel_boxes.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/occlusion/boxes/pixel_boxes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::occlusion {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Boxes are projected by as many lanes as a vector has, and few of them by fewer: on some machines wide
// vectors take twice as long. D is the vectors' tag.
constexpr std::size_t kMaxLanes = 16, kFewLanes = 8;
using Many = hn::CappedTag<float, kMaxLanes>;
using Few = hn::CappedTag<float, kFewLanes>;

constexpr float kRounding = 0x1.4p-21f;      // of a coordinate in camera space, times S
constexpr float kBufferRounding = 0x1p-21f;  // of a position in the buffer, relative
constexpr float kSlackGrowth = 1.0625f;      // for products of two errors
constexpr float kWellConditioned = 64.0f;    // the least depth, as a multiple of its error
constexpr float kLargest = 0x1p60f;          // S of boxes that are projected
constexpr float kUp = 1.0f + 0x1p-21f, kDown = 1.0f - 0x1p-21f;

// Structures of vectors are initialised as a whole: a default constructor that the compiler makes is compiled
// for the machine's basic instruction set, from which it cannot call that of a vector.

// Minima and maxima of one coordinate.
template <class D>
struct Range {
  using Vec = hn::Vec<D>;
  Vec min, max;
};
template <class D>
struct Ranges {
  Range<D> x, y, z;
};

// One box a lane, relative to the eye.
template <class D>
struct EyeBoxes {
  using Vec = hn::Vec<D>;
  using Mask = hn::Mask<D>;
  Range<D> x, y, z;
  Vec reach;  // S
  Vec error;  // E
  Mask usable;
};

template <class D>
HWY_INLINE Ranges<D> loadRanges(D d, const float* floats) {
#if HWY_TARGET == HWY_SCALAR
  return {{hn::Set(d, floats[0]), hn::Set(d, floats[3])},
          {hn::Set(d, floats[1]), hn::Set(d, floats[4])},
          {hn::Set(d, floats[2]), hn::Set(d, floats[5])}};
#else
  hn::Vec<D> x_a, y_a, z_a, x_b, y_b, z_b;
  hn::LoadInterleaved3(d, floats, x_a, y_a, z_a);
  hn::LoadInterleaved3(d, floats + 3 * hn::Lanes(d), x_b, y_b, z_b);
  return {{hn::ConcatEven(d, x_b, x_a), hn::ConcatOdd(d, x_b, x_a)},
          {hn::ConcatEven(d, y_b, y_a), hn::ConcatOdd(d, y_b, y_a)},
          {hn::ConcatEven(d, z_b, z_a), hn::ConcatOdd(d, z_b, z_a)}};
#endif
}

template <class D>
HWY_INLINE EyeBoxes<D> load(D d, const BoxProjection& p, const float* floats) {
  using Vec = hn::Vec<D>;
  using Mask = hn::Mask<D>;
  const auto [x, y, z] = loadRanges(d, floats);
  const auto toEye = [&](const Range<D>& r, float high, float low) HWY_ATTR {
    return Range<D>{hn::Sub(hn::Sub(r.min, hn::Set(d, high)), hn::Set(d, low)),
                    hn::Sub(hn::Sub(r.max, hn::Set(d, high)), hn::Set(d, low))};
  };
  const Range<D> eye_x = toEye(x, p.eye_high.x, p.eye_low.x), eye_y = toEye(y, p.eye_high.y, p.eye_low.y),
                 eye_z = toEye(z, p.eye_high.z, p.eye_low.z);
  const auto size = [](const Range<D>& r) HWY_ATTR { return hn::Max(hn::Abs(r.min), hn::Abs(r.max)); };
  const Vec reach = hn::Add(hn::Add(size(eye_x), size(eye_y)), size(eye_z));
  const Vec error = hn::Add(hn::Mul(reach, hn::Set(d, kRounding)), hn::Set(d, p.eye_rounding));
  const auto good = [](const Range<D>& r) HWY_ATTR { return hn::Le(r.min, r.max); };
  const Mask usable =
      hn::And(hn::And(good(x), good(y)), hn::And(good(z), hn::Le(reach, hn::Set(d, kLargest))));
  return {eye_x, eye_y, eye_z, reach, error, usable};
}

// One coordinate of the eight corners along an axis.
template <class D>
struct Corners {
  using Vec = hn::Vec<D>;
  Vec xy[4], z[2];

  HWY_INLINE Corners(D d, const EyeBoxes<D>& b, const BoxProjection::Axis& axis) {
    const Vec ax = hn::Set(d, axis.x), ay = hn::Set(d, axis.y), az = hn::Set(d, axis.z);
    const Vec x0 = hn::Mul(ax, b.x.min), x1 = hn::Mul(ax, b.x.max);
    const Vec y0 = hn::Mul(ay, b.y.min), y1 = hn::Mul(ay, b.y.max);
    xy[0] = hn::Add(x0, y0);
    xy[1] = hn::Add(x1, y0);
    xy[2] = hn::Add(x0, y1);
    xy[3] = hn::Add(x1, y1);
    z[0] = hn::Mul(az, b.z.min);
    z[1] = hn::Mul(az, b.z.max);
  }
  HWY_INLINE Vec at(std::size_t corner) const { return hn::Add(xy[corner & 3], z[corner >> 2]); }
  HWY_INLINE Vec min() const {
    return hn::Add(hn::Min(hn::Min(xy[0], xy[1]), hn::Min(xy[2], xy[3])), hn::Min(z[0], z[1]));
  }
  HWY_INLINE Vec max() const {
    return hn::Add(hn::Max(hn::Max(xy[0], xy[1]), hn::Max(xy[2], xy[3])), hn::Max(z[0], z[1]));
  }
};

// Bounds of q, the position divided by the depth (orthographic: the position), before rounding.
template <class D>
struct Extent {
  using Vec = hn::Vec<D>;
  Vec x0, x1, y0, y1;
};

template <class D>
HWY_INLINE Extent<D> extentOf(D d, const Corners<D>& x, const Corners<D>& y, const Corners<D>& z,
                              bool orthographic) {
  if (orthographic) {
    return {x.min(), x.max(), y.min(), y.max()};
  }
  using Vec = hn::Vec<D>;
  const Vec one = hn::Set(d, 1.0f);
  Vec inverse = hn::Div(one, z.at(0));
  const Vec first_x = hn::Mul(x.at(0), inverse), first_y = hn::Mul(y.at(0), inverse);
  Extent<D> e{first_x, first_x, first_y, first_y};
  for (std::size_t corner = 1; corner < 8; ++corner) {
    inverse = hn::Div(one, z.at(corner));
    const Vec qx = hn::Mul(x.at(corner), inverse), qy = hn::Mul(y.at(corner), inverse);
    e.x0 = hn::Min(e.x0, qx);
    e.x1 = hn::Max(e.x1, qx);
    e.y0 = hn::Min(e.y0, qy);
    e.y1 = hn::Max(e.y1, qy);
  }
  return e;
}

// Returns a bound of the error of a position in the buffer, pixels. q_error: the error of q for |q| = 0; in
// perspective it grows with 1 + |q|.
template <class D, class Vec = hn::Vec<D>>
HWY_INLINE Vec bufferSlack(D d, Vec q, Vec q_error, float scale, float middle, bool orthographic) {
  const Vec size = hn::Abs(q), rounding = hn::Set(d, kBufferRounding);
  const Vec grown = orthographic ? q_error : hn::Mul(q_error, hn::Add(hn::Set(d, 1.0f), size));
  const Vec in_q = hn::Add(grown, hn::Mul(rounding, size));
  return hn::Add(hn::Mul(hn::Set(d, scale), in_q), hn::Set(d, kBufferRounding * std::abs(middle)));
}

// Whether the box is surely beyond a side of the view's volume. The functions are linear: nothing is divided
// by a depth.
template <class D>
HWY_INLINE hn::Mask<D> beyondASide(D d, const EyeBoxes<D>& boxes, const BoxProjection& p) {
  using Vec = hn::Vec<D>;
  const Vec error = hn::Mul(boxes.error, hn::Set(d, p.side_size));
  hn::Mask<D> beyond = hn::Lt(hn::Zero(d), hn::Zero(d));
  for (const BoxProjection::Axis& side : p.sides) {
    const Vec max = Corners<D>(d, boxes, side).max();
    beyond = hn::Or(beyond, hn::Lt(hn::Add(max, error), hn::Zero(d)));
  }
  return beyond;
}

struct Images {
  HWY_ALIGN std::int32_t place[kMaxLanes], x0[kMaxLanes], y0[kMaxLanes], x1[kMaxLanes], y1[kMaxLanes];
  HWY_ALIGN float nearest[kMaxLanes], farthest[kMaxLanes];
};

constexpr std::int32_t kWholeBit = 256;

template <bool orthographic, class D>
HWY_INLINE void project(D d, const BoxProjection& p, const float* floats, Images& out) {
  using Vec = hn::Vec<D>;
  using Mask = hn::Mask<D>;
  const hn::RebindToSigned<D> di;
  const EyeBoxes<D> boxes = load(d, p, floats);
  const Corners<D> x(d, boxes, p.right), y(d, boxes, p.up), z(d, boxes, p.forward);
  const Vec z_min = hn::Sub(z.min(), boxes.error), z_max = hn::Add(z.max(), boxes.error);

  Mask bounded = hn::And(boxes.usable, hn::Gt(z_min, hn::Set(d, p.near_max)));
  Vec q_error = boxes.error;
  if (!orthographic) {
    bounded = hn::And(bounded, hn::Gt(z_min, hn::Mul(boxes.error, hn::Set(d, kWellConditioned))));
    q_error =
        hn::Add(hn::Mul(hn::Div(boxes.error, z_min), hn::Set(d, kSlackGrowth)), hn::Set(d, kBufferRounding));
  }
  const Extent<D> q = extentOf(d, x, y, z, orthographic);
  const auto toBuffer = [&](Vec at, float scale, float middle, bool upwards) HWY_ATTR {
    const Vec position = hn::Add(hn::Mul(at, hn::Set(d, scale)), hn::Set(d, middle));
    const Vec slack = bufferSlack(d, at, q_error, scale, middle, orthographic);
    return upwards ? hn::Add(position, slack) : hn::Sub(position, slack);
  };
  const Vec x0 = toBuffer(q.x0, p.scale_x, p.middle_x, false),
            x1 = toBuffer(q.x1, p.scale_x, p.middle_x, true);
  const Vec y0 = toBuffer(q.y0, p.scale_y, p.middle_y, false),
            y1 = toBuffer(q.y1, p.scale_y, p.middle_y, true);

  const Vec zero = hn::Zero(d), width = hn::Set(d, p.width), height = hn::Set(d, p.height);
  const Mask off_buffer =
      hn::Or(hn::Or(hn::Lt(x1, zero), hn::Gt(x0, width)), hn::Or(hn::Lt(y1, zero), hn::Gt(y0, height)));
  const Mask off_depth = hn::Or(hn::Lt(z_max, hn::Set(d, p.near_min)), hn::Gt(z_min, hn::Set(d, p.far_max)));
  Mask outside =
      hn::Or(hn::And(boxes.usable, off_depth), hn::And(orthographic ? boxes.usable : bounded, off_buffer));
  const Mask unbounded = hn::AndNot(bounded, hn::AndNot(outside, boxes.usable));
  if (!orthographic && !hn::AllFalse(d, unbounded)) {
    outside = hn::Or(outside, hn::And(unbounded, beyondASide(d, boxes, p)));
  }
  const Mask on_buffer = hn::AndNot(outside, bounded);
  const Mask within =
      hn::And(hn::And(hn::Ge(x0, zero), hn::Le(x1, width)), hn::And(hn::Ge(y0, zero), hn::Le(y1, height)));
  const Mask whole = hn::And(hn::And(on_buffer, within), hn::Lt(z_max, hn::Set(d, p.far_min)));

  const auto mask = [&](Mask m) HWY_ATTR { return hn::RebindMask(di, m); };
  auto place = hn::IfThenElse(mask(on_buffer), hn::Set(di, static_cast<std::int32_t>(BoxPlace::kOnBuffer)),
                              hn::Set(di, static_cast<std::int32_t>(BoxPlace::kUnbounded)));
  place = hn::IfThenElse(mask(outside), hn::Set(di, static_cast<std::int32_t>(BoxPlace::kOutside)), place);
  hn::Store(hn::Or(place, hn::IfThenElseZero(mask(whole), hn::Set(di, kWholeBit))), di, out.place);
  const auto storePixel = [&](Vec at, Vec size, std::int32_t* to) HWY_ATTR {
    const Vec pixel = hn::Min(hn::Max(at, zero), hn::Sub(size, hn::Set(d, 1.0f)));
    hn::Store(hn::ConvertTo(di, hn::IfThenElseZero(on_buffer, pixel)), di, to);
  };
  storePixel(x0, width, out.x0);
  storePixel(x1, width, out.x1);
  storePixel(y0, height, out.y0);
  storePixel(y1, height, out.y1);
  const Vec one = hn::Set(d, 1.0f);
  const Vec nearest = orthographic ? hn::Neg(z_min) : hn::Mul(hn::Div(one, z_min), hn::Set(d, kUp));
  const Vec farthest = orthographic ? hn::Neg(z_max) : hn::Mul(hn::Div(one, z_max), hn::Set(d, kDown));
  hn::Store(hn::IfThenElseZero(on_buffer, nearest), d, out.nearest);
  hn::Store(hn::IfThenElseZero(on_buffer, farthest), d, out.farthest);
}

HWY_INLINE void store(const Images& from, std::size_t count, PixelBox* to) {
  for (std::size_t i = 0; i < count; ++i) {
    PixelBox& image = to[i];
    image.place = static_cast<BoxPlace>(from.place[i] & 0xff);
    image.whole = from.place[i] >= kWholeBit;
    image.x0 = static_cast<std::uint16_t>(from.x0[i]);
    image.y0 = static_cast<std::uint16_t>(from.y0[i]);
    image.x1 = static_cast<std::uint16_t>(from.x1[i]);
    image.y1 = static_cast<std::uint16_t>(from.y1[i]);
    image.nearest = from.nearest[i];
    image.farthest = from.farthest[i];
  }
}

// Calls use(tag, floats of as many items as it has lanes, the first item, the number of items) for all items
// of kFloats floats each. Where they are fewer than the lanes, those that are left are zeros; else the last
// call repeats some items.
template <std::size_t kFloats, class D, typename Use>
HWY_INLINE void forGroupsOf(D d, const float* floats, std::size_t count, const Use& use) {
  const std::size_t lanes = hn::Lanes(d);
  if (count < lanes) {
    HWY_ALIGN float few[kFloats * kMaxLanes];
    for (std::size_t i = 0; i < kFloats; ++i) {
      hn::Store(hn::Zero(d), d, few + i * lanes);
    }
    for (std::size_t i = 0; i < count; ++i) {
      std::memcpy(few + i * kFloats, floats + i * kFloats, kFloats * sizeof(float));
    }
    use(d, few, std::size_t{0}, count);
    return;
  }
  for (std::size_t first = 0; first < count; first += lanes) {
    const std::size_t from = std::min(first, count - lanes);
    use(d, floats + from * kFloats, from, lanes);
  }
}
template <std::size_t kFloats, typename Use>
HWY_INLINE void forGroups(const float* floats, std::size_t count, const Use& use) {
  if constexpr (!std::is_same_v<Few, Many>) {
    if (count <= kFewLanes) {
      forGroupsOf<kFloats>(Few(), floats, count, use);
      return;
    }
  }
  forGroupsOf<kFloats>(Many(), floats, count, use);
}

void projectAll(const BoxProjection& p, std::span<const Box> boxes, std::span<PixelBox> images) {
  static_assert(sizeof(Box) == 6 * sizeof(float));
  if (boxes.empty()) {
    return;
  }
  Images out;
  forGroups<6>(&boxes.front().min.x, boxes.size(),
               [&](auto d, const float* floats, std::size_t first, std::size_t count) HWY_ATTR {
                 if (p.orthographic) {
                   project<true>(d, p, floats, out);
                 } else {
                   project<false>(d, p, floats, out);
                 }
                 store(out, count, images.data() + first);
               });
}

template <bool orthographic, class D>
HWY_INLINE void projectPoints(D d, const BoxProjection& p, const float* floats, PointImage* out) {
  using Vec = hn::Vec<D>;
  using Mask = hn::Mask<D>;
  const hn::RebindToSigned<D> di;
  const Vec zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  Vec x, y, z;
  hn::LoadInterleaved3(d, floats, x, y, z);
  const auto toEye = [&](Vec at, float high, float low)
                         HWY_ATTR { return hn::Sub(hn::Sub(at, hn::Set(d, high)), hn::Set(d, low)); };
  x = toEye(x, p.eye_high.x, p.eye_low.x);
  y = toEye(y, p.eye_high.y, p.eye_low.y);
  z = toEye(z, p.eye_high.z, p.eye_low.z);
  const auto along = [&](const BoxProjection::Axis& axis) HWY_ATTR {
    const Vec xy = hn::Add(hn::Mul(hn::Set(d, axis.x), x), hn::Mul(hn::Set(d, axis.y), y));
    return hn::Add(xy, hn::Mul(hn::Set(d, axis.z), z));
  };
  const Vec reach = hn::Add(hn::Add(hn::Abs(x), hn::Abs(y)), hn::Abs(z));
  const Vec error = hn::Add(hn::Mul(reach, hn::Set(d, kRounding)), hn::Set(d, p.eye_rounding));
  const Vec depth = along(p.forward), z_min = hn::Sub(depth, error), z_max = hn::Add(depth, error);
  Mask known = hn::And(hn::Le(reach, hn::Set(d, kLargest)),
                       hn::And(hn::Gt(z_min, hn::Set(d, p.near_max)), hn::Lt(z_max, hn::Set(d, p.far_min))));
  Vec inverse = one, q_error = error;
  if (!orthographic) {
    known = hn::And(known, hn::Gt(z_min, hn::Mul(error, hn::Set(d, kWellConditioned))));
    inverse = hn::Div(one, depth);
    q_error = hn::Add(hn::Mul(hn::Div(error, z_min), hn::Set(d, kSlackGrowth)), hn::Set(d, kBufferRounding));
  }
  // Returns the pixel; `known` stays true where it is the same one at both ends of the error.
  const auto pixel = [&](Vec c, float scale, float middle, float size) HWY_ATTR {
    const Vec q = orthographic ? c : hn::Mul(c, inverse);
    const Vec position = hn::Add(hn::Mul(q, hn::Set(d, scale)), hn::Set(d, middle));
    const Vec slack = bufferSlack(d, q, q_error, scale, middle, orthographic);
    const Vec first = hn::Sub(position, slack), last = hn::Add(position, slack);
    known = hn::And(known, hn::And(hn::Ge(first, zero), hn::Lt(last, hn::Set(d, size))));
    const auto at = hn::ConvertTo(di, hn::IfThenElseZero(known, first));
    const auto other = hn::ConvertTo(di, hn::IfThenElseZero(known, last));
    known = hn::And(known, hn::RebindMask(d, hn::Eq(at, other)));
    return at;
  };
  const auto column = pixel(along(p.right), p.scale_x, p.middle_x, p.width);
  const auto row = pixel(along(p.up), p.scale_y, p.middle_y, p.height);
  const auto mask = hn::RebindMask(di, known);
  const auto unknown = hn::Set(di, PointImage::kUnknown);
  const Vec farthest = orthographic ? hn::Neg(z_max) : hn::Mul(hn::Div(one, z_max), hn::Set(d, kDown));
  HWY_ALIGN std::int32_t columns[kMaxLanes], rows[kMaxLanes];
  HWY_ALIGN float depths[kMaxLanes];
  hn::Store(hn::IfThenElse(mask, column, unknown), di, columns);
  hn::Store(hn::IfThenElse(mask, row, unknown), di, rows);
  hn::Store(hn::IfThenElseZero(known, farthest), d, depths);
  for (std::size_t i = 0; i < hn::Lanes(d); ++i) {
    out[i] = {columns[i], rows[i], depths[i]};
  }
}

void projectAllPoints(const BoxProjection& p, std::span<const Vec3f> points, std::span<PointImage> images) {
  static_assert(sizeof(Vec3f) == 3 * sizeof(float));
  if (points.empty()) {
    return;
  }
  PointImage out[kMaxLanes];
  forGroups<3>(&points.front().x, points.size(),
               [&](auto d, const float* floats, std::size_t first, std::size_t count) HWY_ATTR {
                 if (p.orthographic) {
                   projectPoints<true>(d, p, floats, out);
                 } else {
                   projectPoints<false>(d, p, floats, out);
                 }
                 std::copy_n(out, count, images.begin() + static_cast<std::ptrdiff_t>(first));
               });
}

}  // namespace HWY_NAMESPACE
}  // namespace sightline::occlusion
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::occlusion {
namespace {

HWY_EXPORT(projectAll);
HWY_EXPORT(projectAllPoints);

constexpr float kFloatMax = std::numeric_limits<float>::max();
BoxProjection::Axis rounded(const Vec3d& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

// At least, at most the value.
float roundedUp(double value) {
  if (!(value <= kFloatMax)) {
    return std::numeric_limits<float>::infinity();
  }
  return std::nextafter(static_cast<float>(value), std::numeric_limits<float>::infinity());
}
float roundedDown(double value) {
  if (!(value <= kFloatMax)) {
    return kFloatMax;
  }
  return std::nextafter(static_cast<float>(value), -std::numeric_limits<float>::infinity());
}

}  // namespace

BoxProjection::BoxProjection(const scene::PixelView& view, std::uint32_t map_width, std::uint32_t map_height)
    : usable(view.sane() && map_width > 0 && map_height > 0), orthographic(view.orthographic) {
  if (!usable) {
    return;
  }
  eye_high = rounded(view.eye);
  eye_low = rounded(view.eye - Vec3d(eye_high.x, eye_high.y, eye_high.z));
  right = rounded(view.right);
  up = rounded(view.up);
  forward = rounded(view.forward);
  sides[0] = rounded(view.right + view.forward * (view.middle_x / view.scale_x));
  sides[1] = rounded(view.forward * ((view.width - view.middle_x) / view.scale_x) - view.right);
  sides[2] = rounded(view.up + view.forward * (view.middle_y / view.scale_y));
  sides[3] = rounded(view.forward * ((view.height - view.middle_y) / view.scale_y) - view.up);
  side_size = roundedUp(1.0 + std::max(view.reachX() / view.scale_x, view.reachY() / view.scale_y));
  near_min = roundedDown(view.frustum_near);
  near_max = roundedUp(view.near);
  far_min = roundedDown(view.far);
  far_max = roundedUp(view.far);
  scale_x = static_cast<float>(view.scale_x);
  scale_y = static_cast<float>(view.scale_y);
  middle_x = static_cast<float>(view.middle_x);
  middle_y = static_cast<float>(view.middle_y);
  width = static_cast<float>(map_width);
  height = static_cast<float>(map_height);
  // What is left of the eye after two floats, thrice, and what underflows.
  const Vec3d size = abs(view.eye);
  eye_rounding = roundedUp(0x1p-46 * (size.x + size.y + size.z) + 0x1p-100);
}

void projectBoxes(const BoxProjection& projection, std::span<const Box> boxes, std::span<PixelBox> images) {
  if (!projection.usable) {
    std::fill_n(images.begin(), boxes.size(), PixelBox{});
    return;
  }
  HWY_DYNAMIC_DISPATCH(projectAll)(projection, boxes, images);
}

void projectBoxes(const scene::PixelView& view, std::uint32_t width, std::uint32_t height,
                  std::span<const Box> boxes, std::span<PixelBox> images) {
  projectBoxes(BoxProjection(view, width, height), boxes, images);
}

void projectPoints(const BoxProjection& projection, std::span<const Vec3f> points,
                   std::span<PointImage> images) {
  if (!projection.usable) {
    std::fill_n(images.begin(), points.size(), PointImage{});
    return;
  }
  HWY_DYNAMIC_DISPATCH(projectAllPoints)(projection, points, images);
}

}  // namespace sightline::occlusion
#endif
