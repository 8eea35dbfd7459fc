#pragma once

// Surfaces made of a few triangles: sheets of hills, panels and boxes.

#include <array>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "tests/support/hand_made.h"

namespace sightline::test {

// A square sheet of hills, count x count squares, as seen from its front: z = -depth + height(x, y).
inline Scene sheet(std::uint32_t count, float size, float depth,
                   const std::function<float(float, float)>& height,
                   const std::function<bool(std::uint32_t)>& leave_out, bool double_sided = false) {
  Scene scene;
  const MaterialId material = hand_made::addMaterial(scene, Opacity::kOpaque, double_sided);
  std::vector<Vec3f> corners;
  const auto at = [&](std::uint32_t i, std::uint32_t j) {
    const float x = size * (static_cast<float>(i) / static_cast<float>(count) - 0.5f),
                y = size * (static_cast<float>(j) / static_cast<float>(count) - 0.5f);
    return Vec3f(x, y, -depth + height(x, y));
  };
  std::uint32_t triangle = 0;
  for (std::uint32_t j = 0; j < count; ++j) {
    for (std::uint32_t i = 0; i < count; ++i) {
      const Vec3f a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
      for (const std::array<Vec3f, 3>& t : {std::array<Vec3f, 3>{a, b, c}, std::array<Vec3f, 3>{a, c, d}}) {
        if (!leave_out(triangle++)) {
          corners.insert(corners.end(), t.begin(), t.end());
        }
      }
    }
  }
  hand_made::addTriangles(scene, material, corners);
  return scene;
}

inline bool noTriangle(std::uint32_t) {
  return false;
}

// A scene of one material with these triangles.
inline Scene sceneOfCorners(std::span<const Vec3f> corners, bool double_sided = false) {
  Scene scene;
  hand_made::addTriangles(scene, hand_made::addMaterial(scene, Opacity::kOpaque, double_sided), corners);
  return scene;
}

// The corners of two triangles that fill a convex quad.
inline void appendQuad(std::vector<Vec3f>& corners, const Vec3f& a, const Vec3f& b, const Vec3f& c,
                       const Vec3f& d) {
  corners.insert(corners.end(), {a, b, c, a, c, d});
}

// The faces of a box, seen from outside or from inside.
inline void appendBox(std::vector<Vec3f>& corners, const Vec3f& low, const Vec3f& high, bool inside) {
  const auto at = [&](int x, int y, int z) {
    return Vec3f(x != 0 ? high.x : low.x, y != 0 ? high.y : low.y, z != 0 ? high.z : low.z);
  };
  const std::size_t first = corners.size();
  appendQuad(corners, at(0, 0, 1), at(1, 0, 1), at(1, 1, 1), at(0, 1, 1));
  appendQuad(corners, at(1, 0, 0), at(0, 0, 0), at(0, 1, 0), at(1, 1, 0));
  appendQuad(corners, at(1, 0, 1), at(1, 0, 0), at(1, 1, 0), at(1, 1, 1));
  appendQuad(corners, at(0, 0, 0), at(0, 0, 1), at(0, 1, 1), at(0, 1, 0));
  appendQuad(corners, at(0, 1, 1), at(1, 1, 1), at(1, 1, 0), at(0, 1, 0));
  appendQuad(corners, at(0, 0, 0), at(1, 0, 0), at(1, 0, 1), at(0, 0, 1));
  for (std::size_t i = first; inside && i < corners.size(); i += 3) {
    std::swap(corners[i + 1], corners[i + 2]);
  }
}

}  // namespace sightline::test
