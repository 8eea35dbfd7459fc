// The farthest vertex of a hull along a direction, for code compiled for one instruction set; Highway
// includes this file once per target. Other code includes support.h.

#if defined(SIGHTLINE_LAYERS_SUPPORT_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SIGHTLINE_LAYERS_SUPPORT_INL_H
#undef SIGHTLINE_LAYERS_SUPPORT_INL_H
#else
#define SIGHTLINE_LAYERS_SUPPORT_INL_H
#endif

#include <hwy/highway.h>

#include <cstddef>

#include "src/layers/hull/support.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::layers::HWY_NAMESPACE {

// Returns the highest neighbour of a vertex, or the vertex if none is higher. Four neighbours are compared at
// once.
HWY_INLINE Support highestAround(const ConvexHull& hull, const Vec3d& direction, const Support& at) {
  namespace hn = hwy::HWY_NAMESPACE;
  const hn::CappedTag<double, 4> d;
  const std::size_t lanes = hn::Lanes(d);
  const auto x = hn::Set(d, direction.x), y = hn::Set(d, direction.y), z = hn::Set(d, direction.z);
  Support best = at;
  const std::uint32_t first = hull.first_quad[at.vertex], last = hull.first_quad[at.vertex + 1];
  for (std::uint32_t quad = first; quad < last; ++quad) {
    const double* corners = hull.neighbour_quads.data() + 12 * std::size_t{quad};
    for (std::size_t i = 0; i < 4; i += lanes) {
      const auto heights =
          hn::Add(hn::Add(hn::Mul(x, hn::LoadU(d, corners + i)), hn::Mul(y, hn::LoadU(d, corners + 4 + i))),
                  hn::Mul(z, hn::LoadU(d, corners + 8 + i)));
      if (HWY_LIKELY(hn::AllFalse(d, hn::Gt(heights, hn::Set(d, best.height))))) {
        continue;
      }
      double each[4];
      hn::StoreU(heights, d, each);
      for (std::size_t k = 0; k < lanes; ++k) {
        if (each[k] > best.height) {
          best = {hull.neighbours[hull.first_neighbour[at.vertex] + 4 * (quad - first) + i + k], each[k]};
        }
      }
    }
  }
  return best;
}

// farthest() for a hull with climbs(hull), from one of its vertices.
HWY_INLINE Support climb(const ConvexHull& hull, const Vec3d& direction, std::uint32_t start) {
  Support at{start, dot(direction, hull.vertices[start])};
  while (true) {
    const Support next = highestAround(hull, direction, at);
    if (HWY_LIKELY(next.vertex == at.vertex)) {
      return at;
    }
    at = next;
  }
}

// farthest() for any hull.
HWY_INLINE Support farthestHere(const ConvexHull& hull, const Vec3d& direction, std::uint32_t start) {
  return HWY_LIKELY(climbs(hull)) ? climb(hull, direction, start < hull.vertices.size() ? start : 0)
                                  : farthestOfAll(hull, direction);
}

}  // namespace sightline::layers::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
