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

// Rounds corners to a grid of at least 1,024 lines for each unit, more on small pages. Everything after that
// is exact, except the corners where borders cross. For one thread at a time. Reuses its memory.
class Outliner {
 public:
  // Outlines reach beyond the page's borders by this share of its height, so that the cut does not show.
  static constexpr double kMargin = 1.0 / 64.0;
  // Rings whose mean width is below this many grid lines are slivers from rounding and are left out, unless
  // a piece of more than twice this width hangs on them.
  static constexpr double kMinWidth = 4.0;

  // Precondition: isDrawable().
  void setView(const View& view, double page_height);

  // Replaces `rings` by the outer borders and holes of what the object draws between the near and the far
  // plane, on the grid, to be filled even-odd. The first corner is not repeated. Backs of single-sided
  // materials are not drawn. Triangles with a corner that is not finite are left out.
  void outline(const SceneView& scene, ObjectId object, std::vector<GridPath>& rings);

  // Sets `hull` to a convex ring, on the grid, around the image of the object, whatever of it is drawn; it
  // may reach beyond the page. The whole page with its margin, if some corner lies before the near plane or
  // far beside the page; empty, if the object has no finite corner.
  void imageHull(const SceneView& scene, ObjectId object, GridPath& hull) const;

  // False if all corners of the object lie beyond one border of the page with its margin, or all before the
  // near or beyond the far plane: the object then shows nothing and hides nothing.
  bool mayShow(const SceneView& scene, ObjectId object) const;

  // The page without its margin, as a ring on the grid.
  GridPath page() const;
  // Rings on the grid as rings on the page.
  void toPage(const std::vector<GridPath>& loops, std::vector<PagePath>& rings) const;

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
  bool mirrored_ = false;                                       // the view is left-handed
  double left_ = 0.0, right_ = 0.0, bottom_ = 0.0, top_ = 0.0;  // of the screen, with the margin
  double scale_ = 1024.0;
  std::vector<Corner> polygon_, scratch_;
  std::vector<GridPoint> ring_;
  OutlineChain chain_;
};

}  // namespace sightline::drawing
