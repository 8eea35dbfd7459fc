#pragma once

// The outline of an object on the page: the union of its drawn triangles.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/base/ids.h"
#include "sightline/drawing/drawing.h"
#include "sightline/math/vec3.h"
#include "sightline/scene/scene.h"
#include "src/drawing/line_view.h"
#include "src/drawing/outline_chain.h"

namespace sightline::drawing {

// Corners are rounded to a grid of at least 1,024 lines a unit, more on small pages. All that follows is
// exact, but for the corners where borders cross. For one thread at a time; keeps its memory.
class Outliner {
 public:
  // Outlines end this share of the page's height beyond its borders, so that the cut is not seen.
  static constexpr double kMargin = 1.0 / 64.0;
  // Rings whose mean width is below this many grid lines are slivers of rounding, and left out.
  static constexpr double kMinWidth = 4.0;

  // Precondition: isDrawable().
  void setView(const View& view, double page_height);

  // rings: replaced. Outer borders and holes of what the object draws between the near and the far plane, to
  // be filled even-odd; the first corner is not repeated. Backs of single-sided materials are not drawn.
  // Triangles with a corner that is not finite are left out.
  void outline(const SceneView& scene, ObjectId object, std::vector<PagePath>& rings);

  // false: all corners of the object lie beyond one border of the page with its margin, or before the near or
  // beyond the far plane; it shows nothing and hides nothing.
  bool mayShow(const SceneView& scene, ObjectId object) const;

  // Grid lines a unit.
  double gridScale() const { return scale_; }

 private:
  struct Corner {
    Vec3d position;  // camera space
  };

  std::uint32_t bordersBeyond(const Vec3d& p) const;
  double borderDistance(std::uint32_t border, const Vec3d& p) const;
  GridPoint onGrid(const Vec3d& p) const;
  void addTriangle(const SceneView& scene, std::span<const std::uint32_t> corners, bool double_sided);
  bool clip(std::uint32_t borders);

  LineView view_;
  double widest_ = 0.0, highest_ = 0.0;  // half of the screen with margin
  double scale_ = 1024.0;
  std::vector<Corner> polygon_, scratch_;
  std::vector<GridPoint> ring_;
  OutlineChain chain_;
  std::vector<GridPath> loops_;
};

}  // namespace sightline::drawing
