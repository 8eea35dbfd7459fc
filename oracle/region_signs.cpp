#include "oracle/region_signs.h"

#include <algorithm>
#include <array>

namespace sightline {

Sign sideOf(const Corners& t, const Vec3d& p) {
  const Vec3d a = t.a - p, b = t.b - p, c = t.c - p;
  const double la = sizeOf(a), lb = sizeOf(b), lc = sizeOf(c);
  const double shift = 0x1p-50 * (sizeOf(p) + std::max({sizeOf(t.a), sizeOf(t.b), sizeOf(t.c)}));
  return {-dot(a, cross(b, c)), kProductDoubt * la * lb * lc + 4.0 * shift * (la * lb + lb * lc + lc * la)};
}

std::optional<int> crossing(const Corners& t, const Vec3d& from, const Vec3d& to) {
  const Sign start = sideOf(t, from), end = sideOf(t, to);
  if ((start.positive() && end.positive()) || (start.negative() && end.negative())) {
    return 0;
  }
  const std::array<Sign, 3> edges{sideOf({from, t.a, t.b}, to), sideOf({from, t.b, t.c}, to),
                                  sideOf({from, t.c, t.a}, to)};
  int plus = 0, minus = 0;
  for (const Sign& edge : edges) {
    plus += edge.positive() ? 1 : 0;
    minus += edge.negative() ? 1 : 0;
  }
  if (plus > 0 && minus > 0) {
    return 0;
  }
  if (plus + minus < 3 || !(start.positive() || start.negative()) || !(end.positive() || end.negative())) {
    return std::nullopt;
  }
  return start.positive() ? 1 : -1;
}

}  // namespace sightline
