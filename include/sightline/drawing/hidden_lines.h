#pragma once

// Finds the pieces of lines that no triangle of some objects hides.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sightline/base/ids.h"
#include "sightline/drawing/feature_edges.h"
#include "sightline/scene/camera.h"
#include "sightline/scene/scene.h"

namespace sightline {

// A point on the page, in units of the view's height / page_height: x to the right, y down from the upper
// border.
struct PagePoint {
  double x = 0.0, y = 0.0;
  friend bool operator==(const PagePoint&, const PagePoint&) = default;
};

struct LinePiece {
  PagePoint from{}, to{};                   // within the page
  double from_share = 0.0, to_share = 1.0;  // the ends as shares of the line from a to b, in space
  FeatureLine line{};
};

struct HiddenLineStats {
  std::uint64_t lines = 0, pieces = 0;
  std::uint64_t tests = 0;  // pairs of a line and a triangle for which the hidden part was computed
};

// The triangles of all objects for one view. For one thread at a time. Keeps its memory between views.
//
// Everything is computed in double precision relative to the eye, and nothing is sampled: the part of a line
// that a triangle hides is the solution of linear inequalities in the line's share, also if triangle or line
// reach behind the near plane. Rounding is treated so:
//   - A point nearer to a triangle's plane than 2^-21 of the largest coordinate of triangle or line (twice
//     the rounding of single precision) lies in the plane. A triangle does not hide what lies in its plane. A
//     line that leaves the plane backwards is hidden from the plane on.
//   - A point that touches the triangle's border in the picture, within 2^-48 of the sizes that it is
//     computed from, is covered, so that adjacent triangles leave no gap.
//   - Pieces beside hidden stretches are left out if they are shorter than 2^-18 of the page's height; hidden
//     stretches shorter than that do not divide a piece.
// Triangles with the eye in their plane, without area, or with corners that are not finite hide nothing.
// Axes of other lengths are normalised. A perspective view whose z_near is below 2^-40 m begins at that
// depth. Lines with ends that are not finite give no pieces, nor do lines of an invalid view: z_near is
// negative, z_far is not beyond it, there is no size, an axis is zero, or a number other than z_far is not
// finite.
class HiddenLines {
 public:
  HiddenLines();
  ~HiddenLines();
  HiddenLines(HiddenLines&&) noexcept;
  HiddenLines& operator=(HiddenLines&&) noexcept;

  // Reads the triangles that hide: those that are drawn, beyond the near plane. Backs of single-sided
  // materials hide nothing, nor do blended and alpha-tested materials. The page is page_height units high and
  // as wide as the view's aspect says; without a valid size (1e-15 to 1e15 units on each side) no line is
  // visible. The scene's memory is not needed afterwards. Takes n log n time for n triangles.
  void setView(const SceneView& scene, const View& view, double page_height);

  // Appends the pieces of the lines that lie in the view and that no triangle of the occluders hides, in the
  // order of the lines and along each line. Pieces without length are left out; a line seen end on gives
  // none. Each call builds a tree of the occluders, so one call with many lines is faster than many calls.
  // Once grown, allocates nothing but `pieces`.
  void visiblePieces(std::span<const FeatureLine> lines, std::span<const ObjectId> occluders,
                     std::vector<LinePiece>& pieces);

  const HiddenLineStats& stats() const;  // counts since setView()

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
