#include "src/pvs/bake/surfaces/sheet_crossings.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "sightline/geometry/tolerance.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/pvs/bake/surfaces/sheet_crossings.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef SIGHTLINE_SHEET_CROSSINGS_ONCE
#define SIGHTLINE_SHEET_CROSSINGS_ONCE
namespace sightline::pvs {

constexpr std::size_t kSheetLanes = 4;

// Up to four sheets, one a lane: by corner and axis, metres. Lanes that hold no sheet hold any finite
// numbers.
struct SheetLanes {
  alignas(32) double corner[3][3][kSheetLanes];
};

// What holds for all sheets.
struct LineLanes {
  SightLine line;
  double doubt = 0.0;  // of a determinant with the line's direction
};

}  // namespace sightline::pvs
#endif

HWY_BEFORE_NAMESPACE();
namespace sightline::pvs {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<double, kSheetLanes>;
constexpr Lanes kLanes{};
using Numbers = hn::Vec<Lanes>;

struct Vectors {
  Numbers x, y, z;
};

HWY_INLINE Vectors load(const double (&corner)[3][kSheetLanes], std::size_t first) {
  return {hn::Load(kLanes, corner[0] + first), hn::Load(kLanes, corner[1] + first),
          hn::Load(kLanes, corner[2] + first)};
}
HWY_INLINE Vectors same(const Vec3d& v) {
  return {hn::Set(kLanes, v.x), hn::Set(kLanes, v.y), hn::Set(kLanes, v.z)};
}
HWY_INLINE Vectors difference(const Vectors& a, const Vectors& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
// No fused operations: they would round differently on different instruction sets.
HWY_INLINE Numbers dot(const Vectors& a, const Vectors& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE Vectors cross(const Vectors& a, const Vectors& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}
HWY_INLINE Numbers size(const Vectors& a) {
  return hn::Add(hn::Add(hn::Abs(a.x), hn::Abs(a.y)), hn::Abs(a.z));
}

struct Side {
  hn::Mask<Lanes> positive, negative;
};

// On which sides of the sheets with these corners, relative to a point, the point is: positive in front.
HWY_INLINE Side sideOf(const Vectors& a, const Vectors& b, const Vectors& c, double error) {
  const Numbers by = hn::Set(kLanes, error);
  const Numbers sa = hn::Add(size(a), by), sb = hn::Add(size(b), by), sc = hn::Add(size(c), by);
  const Numbers areas = hn::Add(hn::Add(hn::Mul(sa, sb), hn::Mul(sb, sc)), hn::Mul(sc, sa));
  const Numbers rounding = hn::Mul(hn::Mul(hn::Mul(hn::Set(kLanes, kDeterminantRounding), sa), sb), sc);
  const Numbers doubt = hn::Add(rounding, hn::Mul(hn::Set(kLanes, 4.0 * error), areas));
  const Numbers value = dot(c, cross(b, a));
  return {hn::Gt(value, doubt), hn::Lt(value, hn::Neg(doubt))};
}

// Adds the crossings of the first `count` of the sheets.
void addCrossings(const SheetLanes& sheets, std::size_t count, const LineLanes& with,
                  SheetCrossings& crossings) {
  const SightLine& line = with.line;
  const Vectors from = same(line.from), to = same(line.to), along = same(line.to - line.from);
  const Numbers doubt = hn::Set(kLanes, with.doubt), below = hn::Neg(doubt);
  for (std::size_t first = 0; first < count; first += hn::Lanes(kLanes)) {
    const Vectors corner_a = load(sheets.corner[0], first), corner_b = load(sheets.corner[1], first),
                  corner_c = load(sheets.corner[2], first);
    const Vectors a = difference(corner_a, from), b = difference(corner_b, from),
                  c = difference(corner_c, from);
    // The signs tell on which side of the sheet's three edges the line passes.
    const Numbers ab = dot(along, cross(a, b)), bc = dot(along, cross(b, c)), ca = dot(along, cross(c, a));
    const Numbers least = hn::Min(hn::Min(ab, bc), ca), most = hn::Max(hn::Max(ab, bc), ca);
    const auto beside = hn::And(hn::Lt(least, below), hn::Gt(most, doubt));
    auto met = hn::AndNot(beside, hn::FirstN(kLanes, count - first));
    if (hn::AllFalse(kLanes, met)) {
      continue;
    }
    const Side start = sideOf(a, b, c, line.error),
               end = sideOf(difference(corner_a, to), difference(corner_b, to), difference(corner_c, to),
                            line.error);
    met =
        hn::AndNot(hn::Or(hn::And(start.positive, end.positive), hn::And(start.negative, end.negative)), met);
    const auto within = hn::And(met, hn::Or(hn::Gt(least, doubt), hn::Lt(most, below)));
    const auto forward = hn::And(met, hn::And(start.positive, end.negative));
    const auto backward = hn::And(met, hn::And(start.negative, end.positive));
    const auto sure = hn::And(within, hn::Or(forward, backward));
    crossings.in_doubt = crossings.in_doubt || !hn::AllFalse(kLanes, hn::AndNot(sure, met));
    crossings.front = crossings.front || !hn::AllFalse(kLanes, forward);
    crossings.sum += static_cast<std::int32_t>(hn::CountTrue(kLanes, hn::And(within, forward)));
    crossings.sum -= static_cast<std::int32_t>(hn::CountTrue(kLanes, hn::And(within, backward)));
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sightline::pvs
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::pvs {
namespace {

HWY_EXPORT(addCrossings);

}  // namespace

SheetCrossings crossSheets(std::span<const Vec3d> vertices, std::span<const std::uint32_t> corners,
                           const SightLine& line, double far) {
  // One bound for all of the sheets.
  const LineLanes lanes{line, doubtOf(l1Norm(line.to - line.from) + line.error, far, far, line.error)};
  SheetCrossings crossings;
  SheetLanes sheets{};
  for (std::size_t first = 0; first < corners.size(); first += 3 * kSheetLanes) {
    const std::size_t count = std::min(kSheetLanes, (corners.size() - first) / 3);
    for (std::size_t lane = 0; lane < count; ++lane) {
      const std::uint32_t* sheet = corners.data() + first + 3 * lane;
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const Vec3d& place = vertices[sheet[corner]];
        sheets.corner[corner][0][lane] = place.x;
        sheets.corner[corner][1][lane] = place.y;
        sheets.corner[corner][2][lane] = place.z;
      }
    }
    HWY_DYNAMIC_DISPATCH(addCrossings)(sheets, count, lanes, crossings);
  }
  return crossings;
}

}  // namespace sightline::pvs
#endif
