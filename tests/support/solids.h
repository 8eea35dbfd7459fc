#pragma once

// Closed solids for tests of convex bodies: corners, and faces as seen from outside.

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <tuple>
#include <vector>

#include "sightline/math/vec3.h"

namespace sightline::test {

struct Solid {
  std::vector<Vec3f> points;
  std::vector<std::vector<std::uint32_t>> faces;  // flat; counter-clockwise as seen from outside

  std::vector<Vec3f> polygon(std::size_t face) const {
    std::vector<Vec3f> corners;
    for (const std::uint32_t i : faces[face]) {
      corners.push_back(points[i]);
    }
    return corners;
  }
};

// Bits of the corner index: bit 0 for x, bit 1 for y, bit 2 for z.
inline Solid block(const Vec3f& low, const Vec3f& high) {
  Solid solid;
  for (int i = 0; i < 8; ++i) {
    solid.points.emplace_back((i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y,
                              (i & 4) != 0 ? high.z : low.z);
  }
  solid.faces = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  return solid;
}

// The same with each face cut into squares, `cuts` along each edge.
inline Solid dicedBlock(const Vec3f& low, const Vec3f& high, int cuts) {
  const Solid whole = block(low, high);
  Solid solid;
  std::map<std::tuple<float, float, float>, std::uint32_t> number;
  const auto pointAt = [&](const std::vector<Vec3f>& side, int i, int j) {
    const double s = static_cast<double>(i) / cuts, t = static_cast<double>(j) / cuts;
    const Vec3f p(Vec3d(side[0]) + (Vec3d(side[1]) - Vec3d(side[0])) * s +
                  (Vec3d(side[3]) - Vec3d(side[0])) * t);
    const auto [at, is_new] =
        number.try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(solid.points.size()));
    if (is_new) {
      solid.points.push_back(p);
    }
    return at->second;
  };
  for (std::size_t face = 0; face < whole.faces.size(); ++face) {
    const std::vector<Vec3f> side = whole.polygon(face);
    for (int j = 0; j < cuts; ++j) {
      for (int i = 0; i < cuts; ++i) {
        solid.faces.push_back({pointAt(side, i, j), pointAt(side, i + 1, j), pointAt(side, i + 1, j + 1),
                               pointAt(side, i, j + 1)});
      }
    }
  }
  return solid;
}

inline Solid octahedron() {
  return {{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
          {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
}

inline Solid tetrahedron() {
  return {{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}, {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}}};
}

// An upright prism over a regular polygon, from z = -1 to 1.
inline Solid prism(std::uint32_t sides) {
  Solid solid;
  std::vector<std::uint32_t> bottom, top;
  for (std::uint32_t i = 0; i < sides; ++i) {
    const double t = 6.283185307179586 * i / sides;
    const auto x = static_cast<float>(std::cos(t)), y = static_cast<float>(std::sin(t));
    solid.points.emplace_back(x, y, -1.0f);
    solid.points.emplace_back(x, y, 1.0f);
    const std::uint32_t next = (i + 1) % sides;
    solid.faces.push_back({2 * i, 2 * next, 2 * next + 1, 2 * i + 1});
    bottom.insert(bottom.begin(), 2 * i);
    top.push_back(2 * i + 1);
  }
  solid.faces.push_back(bottom);
  solid.faces.push_back(top);
  return solid;
}

// A prism over an L of three unit squares with its notch at (1, 1); top and bottom consist of two
// quadrilaterals each.
inline Solid lShape() {
  Solid solid;
  constexpr std::array<std::array<float, 2>, 6> kOutline{{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}};
  for (const auto& [x, y] : kOutline) {
    solid.points.emplace_back(x, y, 0.0f);
    solid.points.emplace_back(x, y, 1.0f);
  }
  for (std::uint32_t i = 0; i < 6; ++i) {
    const std::uint32_t next = (i + 1) % 6;
    solid.faces.push_back({2 * i, 2 * next, 2 * next + 1, 2 * i + 1});
  }
  solid.faces.push_back({1, 3, 5, 7});
  solid.faces.push_back({1, 7, 9, 11});
  solid.faces.push_back({0, 6, 4, 2});
  solid.faces.push_back({0, 10, 8, 6});
  return solid;
}

// Not a solid: an L with its outer corner cut off and its notch at (0, 0), once with its front upwards and
// once downwards, each of two convex halves that are joined at different places.
inline Solid notchedSheet() {
  return {{{0, 0, 0}, {0, 2, 0}, {-2, 2, 0}, {-2, -1, 0}, {-1, -2, 0}, {2, -2, 0}, {2, 0, 0}},
          {{0, 1, 2, 3}, {0, 3, 4, 5, 6}, {0, 4, 3, 2, 1}, {0, 6, 5, 4}}};
}

// The solid with its x and y axes along these orthonormal vectors.
inline Solid placed(Solid solid, const Vec3d& origin, const Vec3d& x, const Vec3d& y,
                    const Vec3d& scale = {1, 1, 1}) {
  const Vec3d z = cross(x, y);
  for (Vec3f& p : solid.points) {
    p = Vec3f(origin + x * (scale.x * p.x) + y * (scale.y * p.y) + z * (scale.z * p.z));
  }
  return solid;
}

}  // namespace sightline::test
