#include "src/scene/cell_grid.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/scene/cell_grid.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::scene {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;  // a slab in each lane
using FloatsV = hn::Vec<Floats>;
inline constexpr Floats kFloats;

// Equal slabs are no thinner than the box's longest side divided by this.
constexpr double kFinest = 64.0;
// So many different coordinates are few. Where there are more, a mesh of many triangles has twice as many
// slabs.
constexpr std::uint32_t kFew = 15;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Planes strictly within a box, ascending or not.
struct Planes {
  std::uint32_t count = 0;
  alignas(64) std::array<float, kMaxSlabs> at{};
};

// The coordinates of corners that lie strictly between two others. False if they are more than few.
HWY_INLINE bool findFew(std::span<const Vec3f> corners, int axis, float low, float high, Planes& planes) {
  planes.at.fill(kInfinity);
  for (const Vec3f& corner : corners) {
    const float at = corner[axis];
    bool known = at <= low || at >= high;
    for (std::size_t i = 0; i < planes.count; i += hn::Lanes(kFloats)) {
      known |= !hn::AllFalse(kFloats, hn::Eq(hn::Load(kFloats, &planes.at[i]), hn::Set(kFloats, at)));
    }
    if (known) {
      continue;
    }
    if (planes.count == kFew) {
      return false;
    }
    planes.at[planes.count++] = at;
  }
  return true;
}

// Planes at equal distances.
HWY_INLINE void addEqual(float low, float high, std::uint32_t count, Planes& planes) {
  for (std::uint32_t i = 1; i <= count; ++i) {
    planes.at[planes.count++] = static_cast<float>(low + (double{high} - low) * i / (count + 1));
  }
}

// Moves equal planes to the nearest coordinates of corners.
HWY_INLINE void moveToCorners(std::span<const Vec3f> corners, int axis, float low, float high,
                              Planes& planes) {
  const std::uint32_t slabs = planes.count + 1;
  const double scale = slabs / (double{high} - low);
  std::array<double, kMaxSlabs> distance;
  distance.fill(1.0);
  for (const Vec3f& corner : corners) {
    const double place = (double{corner[axis]} - low) * scale;
    const auto nearest = static_cast<std::uint32_t>(std::floor(place + 0.5));
    const double from = std::abs(place - nearest);
    if (nearest > 0 && nearest < slabs && from < distance[nearest]) {
      distance[nearest] = from;
      planes.at[nearest - 1] = corner[axis];
    }
  }
}

HWY_INLINE Slabs slabsOf(std::span<const Vec3f> corners, int axis, float low, float high, double scale) {
  Planes planes;
  if (findFew(corners, axis, low, high, planes)) {
    const double fine = std::ceil((double{high} - low) * scale * kFinest);
    addEqual(low, high, std::min(kFew - planes.count, static_cast<std::uint32_t>(fine)), planes);
    std::sort(planes.at.begin(), planes.at.begin() + planes.count);
  } else {
    planes.count = 0;
    addEqual(low, high, corners.size() < 3 * kManyTriangles ? kFew : kMaxSlabs - 1, planes);
    moveToCorners(corners, axis, low, high, planes);
  }
  Slabs slabs;
  slabs.plane[0] = low;
  for (std::uint32_t i = 0; i < planes.count; ++i) {
    if (planes.at[i] > slabs.plane[slabs.count - 1] && planes.at[i] < high) {
      slabs.plane[slabs.count++] = planes.at[i];
    }
  }
  const auto place = [&](float at) HWY_ATTR { return static_cast<float>((double{at} - low) * scale); };
  slabs.end.fill(kInfinity);
  for (std::uint32_t i = 0; i < slabs.count; ++i) {
    slabs.low[i] = place(slabs.plane[i]);
    slabs.high[i] = place(i + 1 < slabs.count ? slabs.plane[i + 1] : high);
    slabs.end[i] = i + 1 < slabs.count ? slabs.high[i] : kInfinity;
  }
  return slabs;
}

// Slabs along one axis, from the first to the last one.
struct Range {
  std::uint32_t first, last;

  bool one() const { return first == last; }
  std::uint32_t bits() const { return (2u << last) - (1u << first); }
};

// Marks triangles, one after the other. A cell is marked if no plane separates it from the triangle: one
// across an axis, along an edge and an axis, or the triangle's own
// (T. Akenine-Moeller, Fast 3D Triangle-Box Overlap Testing, Journal of Graphics Tools 6(1), 2001).
class Marker {
 public:
  HWY_INLINE Marker(const std::array<Slabs, 3>& slabs, std::array<SlabMasks, kMaxSlabs>& marked)
      : slabs_(slabs), marked_(marked) {}

  // places: of the corners, by axis and corner, measured as Slabs::low.
  HWY_INLINE void mark(const float (&places)[3][3]) {
    places_ = places;
    for (int axis = 0; axis < 3; ++axis) {
      ranges_[axis] = rangeOf(axis);
    }
    const auto& [x, y, z] = ranges_;
    if (x.one() + y.one() + z.one() >= 2) {
      for (std::uint32_t i = x.first; i <= x.last; ++i) {
        for (std::uint32_t j = y.first; j <= y.last; ++j) {
          marked_[i][j] |= z.bits();
        }
      }
      return;
    }
    SlabMasks y_of_x, z_of_x, z_of_y;
    project(0, 1, y_of_x);
    project(0, 2, z_of_x);
    project(1, 2, z_of_y);
    const float normal[3] = {areaAlong(0), areaAlong(1), areaAlong(2)};
    if (normal[0] == 0.0f || normal[1] == 0.0f || normal[2] == 0.0f) {
      for (std::uint32_t i = x.first; i <= x.last; ++i) {
        for (std::uint32_t j = y.first; j <= y.last; ++j) {
          marked_[i][j] |= (y_of_x[i] >> j & 1u) != 0 ? z_of_y[j] & z_of_x[i] : 0u;
        }
      }
    } else {
      markBesidePlane(normal, y_of_x, z_of_x, z_of_y);
    }
  }

 private:
  // The first slab of the vector that holds a range's first one.
  static HWY_INLINE std::size_t firstOf(const Range& range) {
    return range.first / hn::Lanes(kFloats) * hn::Lanes(kFloats);
  }
  // Stores, by slab of its range, how far an affine function that has the value 0 at `from` and grows by
  // `slope` along the axis goes there at most.
  HWY_INLINE void storeMost(int axis, float slope, float from, float* most) const {
    const Slabs& slabs = slabs_[axis];
    const float* const ends = slope > 0.0f ? slabs.high.data() : slabs.low.data();
    for (std::size_t i = firstOf(ranges_[axis]); i <= ranges_[axis].last; i += hn::Lanes(kFloats)) {
      const FloatsV distance = hn::Sub(hn::Load(kFloats, ends + i), hn::Set(kFloats, from));
      hn::Store(hn::Mul(hn::Set(kFloats, slope), distance), kFloats, most + i);
    }
  }
  static HWY_INLINE std::uint32_t bitsOf(hn::Mask<Floats> mask) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(kFloats, mask, bytes);
    return bytes[0] | std::uint32_t{bytes[1]} << 8;
  }
  // Twice the area of the projection along an axis, signed.
  HWY_INLINE float areaAlong(int axis) const {
    const float* const u = places_[axis < 2 ? axis + 1 : 0];
    const float* const v = places_[axis > 0 ? axis - 1 : 2];
    return (u[1] - u[0]) * (v[2] - v[0]) - (v[1] - v[0]) * (u[2] - u[0]);
  }

  HWY_INLINE Range rangeOf(int axis) const {
    const float* const at = places_[axis];
    const float low = std::min(std::min(at[0], at[1]), at[2]);
    const float high = std::max(std::max(at[0], at[1]), at[2]);
    std::size_t first = 0, last = 0;
    for (std::size_t i = 0; i < slabs_[axis].count; i += hn::Lanes(kFloats)) {
      const FloatsV end = hn::Load(kFloats, slabs_[axis].end.data() + i);
      first += hn::CountTrue(kFloats, hn::Le(end, hn::Set(kFloats, low)));
      last += hn::CountTrue(kFloats, hn::Lt(end, hn::Set(kFloats, high)));
    }
    if (first > last) {  // it lies in a plane
      (areaAlong(axis) > 0.0f ? first : last) = areaAlong(axis) > 0.0f ? last : first;
    }
    return {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(last)};
  }

  // By slab along u: the slabs along v that the triangle's projection reaches there.
  HWY_INLINE void project(int u, int v, SlabMasks& slabs) const {
    const Range along_u = ranges_[u];
    const std::uint32_t all = ranges_[v].bits();
    if (along_u.one() || ranges_[v].one()) {
      std::fill(slabs.begin() + along_u.first, slabs.begin() + along_u.last + 1, all);
      return;
    }
    // A cell is reached if the sum of these two is positive for each edge.
    alignas(64) float most_u[6][kMaxSlabs];
    alignas(64) float most_v[6][kMaxSlabs];
    std::size_t edges = 0;
    const auto add = [&](float slope_u, float slope_v, std::size_t k) HWY_ATTR {
      storeMost(u, slope_u, places_[u][k], most_u[edges]);
      storeMost(v, slope_v, places_[v][k], most_v[edges]);
      ++edges;
    };
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = k < 2 ? k + 1 : 0, other = 3 - k - next;
      const float du = places_[u][next] - places_[u][k], dv = places_[v][next] - places_[v][k];
      if (du == 0.0f || dv == 0.0f) {
        continue;  // the ranges say as much
      }
      const float side = du * (places_[v][other] - places_[v][k]) - dv * (places_[u][other] - places_[u][k]);
      if (side >= 0.0f) {
        add(-dv, du, k);
      }
      if (side <= 0.0f) {
        add(dv, -du, k);
      }
    }
    for (std::uint32_t i = along_u.first; i <= along_u.last; ++i) {
      std::uint32_t reached = 0;
      for (std::size_t j = firstOf(ranges_[v]); j <= ranges_[v].last; j += hn::Lanes(kFloats)) {
        hn::Mask<Floats> inside = hn::FirstN(kFloats, kMaxSlabs);
        for (std::size_t edge = 0; edge < edges; ++edge) {
          const FloatsV sum = hn::Add(hn::Set(kFloats, most_u[edge][i]), hn::Load(kFloats, most_v[edge] + j));
          inside = hn::And(inside, hn::Gt(sum, hn::Zero(kFloats)));
        }
        reached |= bitsOf(inside) << j;
      }
      slabs[i] = reached & all;
    }
  }

  // Marks what is reached by all three projections and by the triangle's plane.
  HWY_INLINE void markBesidePlane(const float (&normal)[3], const SlabMasks& y_of_x, const SlabMasks& z_of_x,
                                  const SlabMasks& z_of_y) {
    // Distances from the plane, by axis and slab: the largest on each side of it.
    alignas(64) float before[3][kMaxSlabs];
    alignas(64) float behind[3][kMaxSlabs];
    for (int axis = 0; axis < 3; ++axis) {
      storeMost(axis, normal[axis], places_[axis][0], before[axis]);
      storeMost(axis, -normal[axis], places_[axis][0], behind[axis]);
    }
    for (std::uint32_t x = ranges_[0].first; x <= ranges_[0].last; ++x) {
      for (std::uint32_t rest = y_of_x[x]; rest != 0; rest &= rest - 1) {
        const auto y = static_cast<std::uint32_t>(std::countr_zero(rest));
        std::uint32_t reached = 0;
        for (std::size_t j = firstOf(ranges_[2]); j <= ranges_[2].last; j += hn::Lanes(kFloats)) {
          const FloatsV most_before =
              hn::Add(hn::Set(kFloats, before[0][x] + before[1][y]), hn::Load(kFloats, before[2] + j));
          const FloatsV most_behind =
              hn::Add(hn::Set(kFloats, behind[0][x] + behind[1][y]), hn::Load(kFloats, behind[2] + j));
          reached |= bitsOf(hn::Gt(hn::Min(most_before, most_behind), hn::Zero(kFloats))) << j;
        }
        marked_[x][y] |= reached & z_of_x[x] & z_of_y[y];
      }
    }
  }

  const std::array<Slabs, 3>& slabs_;
  std::array<SlabMasks, kMaxSlabs>& marked_;
  const float (*places_)[3] = nullptr;
  Range ranges_[3]{};
};

// What CellGrid holds.
void makeGrid(const Box& box, std::span<const Vec3f> corners, std::array<Slabs, 3>& slabs,
              std::array<SlabMasks, kMaxSlabs>& marked) {
  const Vec3d from(box.min);
  const double longest = maxComponent(Vec3d(box.max) - from);
  const double scale = longest > 0.0 ? 1.0 / longest : 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    slabs[axis] = slabsOf(corners, axis, box.min[axis], box.max[axis], scale);
  }
  Marker marker(slabs, marked);
  for (std::size_t t = 0; t < corners.size(); t += 3) {
    float places[3][3];
    for (int axis = 0; axis < 3; ++axis) {
      for (std::size_t k = 0; k < 3; ++k) {
        places[axis][k] = static_cast<float>((corners[t + k][axis] - from[axis]) * scale);
      }
    }
    marker.mark(places);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sightline::scene
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::scene {

HWY_EXPORT(makeGrid);

CellGrid::CellGrid(const Box& box, std::span<const Vec3f> corners) {
  HWY_DYNAMIC_DISPATCH(makeGrid)(box, corners, slabs_, marked_);
}

}  // namespace sightline::scene
#endif
