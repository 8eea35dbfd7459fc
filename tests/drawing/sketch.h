#pragma once

// Small scenes for tests of hidden lines, and views of them.

#include <array>
#include <cstdint>
#include <vector>

#include "sightline/drawing/hidden_lines.h"
#include "tests/support/square_view.h"

namespace sightline::test {

using Triangle = std::array<Vec3f, 3>;
inline constexpr double kPage = 100.0;

inline std::vector<Triangle> quad(const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d) {
  return {{a, b, c}, {a, c, d}};
}

// A view along -z with the eye at zero and a square page whose borders are at 45 degrees.
inline View squareView() {
  return squareView(1.0, 100.0);
}

inline View flatView(double height) {
  View view = squareView();
  view.orthographic = true;
  view.ortho_height = height;
  return view;
}

// A scene of a few triangles, with lines between any points.
struct Sketch {
  Scene scene;

  Sketch() {
    scene.materials = {{.name = "double-sided", .double_sided = true},
                       {.name = "single-sided"},
                       {.name = "glass", .opacity = Opacity::kBlended, .double_sided = true},
                       {.name = "leaves", .opacity = Opacity::kAlphaTested, .double_sided = true}};
  }
  std::uint32_t point(const Vec3f& p) {
    scene.positions.push_back(p);
    return static_cast<std::uint32_t>(scene.positions.size() - 1);
  }
  ObjectId add(const std::vector<Triangle>& triangles, std::uint32_t material = 0) {
    Object object;
    object.first_index = static_cast<std::uint32_t>(scene.indices.size());
    object.index_count = static_cast<std::uint32_t>(3 * triangles.size());
    object.material = MaterialId(material);
    for (const Triangle& triangle : triangles) {
      for (const Vec3f& corner : triangle) {
        scene.indices.push_back(point(corner));
      }
    }
    scene.objects.push_back(object);
    return ObjectId(scene.objects.size() - 1);
  }
  FeatureLine line(const Vec3f& a, const Vec3f& b) {
    const std::uint32_t first = point(a);
    return {first, point(b), LineKind::kCrease};
  }
  std::vector<ObjectId> all() const {
    std::vector<ObjectId> ids;
    for (std::uint32_t i = 0; i < scene.objects.size(); ++i) {
      ids.emplace_back(i);
    }
    return ids;
  }
  std::vector<LinePiece> pieces(const View& view, const FeatureLine& line) const {
    HiddenLines hidden;
    hidden.setView(scene.view(), view, kPage);
    std::vector<LinePiece> found;
    hidden.visiblePieces({&line, 1}, all(), found);
    return found;
  }
};

}  // namespace sightline::test
