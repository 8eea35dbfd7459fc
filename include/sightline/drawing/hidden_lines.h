#pragma once

// Which pieces of lines are visible past which objects.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sightline/base/ids.h"
#include "sightline/drawing/feature_edges.h"
#include "sightline/scene/camera.h"
#include "sightline/scene/scene.h"

namespace sightline {

// On the page: units of the view's height / page_height, x to the right, y down from the upper border.
struct PagePoint {
  double x = 0.0, y = 0.0;
  friend bool operator==(const PagePoint&, const PagePoint&) = default;
};

struct LinePiece {
  PagePoint from{}, to{};                   // within the page
  double from_share = 0.0, to_share = 1.0;  // where they lie on the line from a to b, in space
  FeatureLine line{};
};

struct HiddenLineStats {
  std::uint64_t lines = 0, pieces = 0;
  std::uint64_t tests = 0;  // pairs of a line and a triangle for which the hidden part was computed
};

// The triangles of all objects for one view. For one thread at a time. Keeps its memory between views.
//
// All is done in double precision relative to the eye, and nothing is sampled: the hidden part of a line past
// a triangle is the solution of linear inequalities in its share, also for triangles and lines that reach
// behind the near plane. Where rounding leaves doubt:
//   - A point nearer to a triangle's plane than 2^-21 of the largest coordinate of triangle or line (what
//     single precision rounds to, twice over) is in the plane; a stretch of line in the plane is not hidden
//     by the triangle. A line that leaves the plane backwards is hidden from the plane on.
//   - What touches the triangle's border in the picture is behind it, within 2^-48 of the sizes that it is
//     computed from, so that triangles that adjoin each other leave no gap.
//   - Pieces beside hidden stretches are left out if they are shorter than 2^-18 of the page's height;
//     hidden stretches shorter than that do not part a piece.
// Triangles that the eye lies in the plane of, or without area, or with corners that are not finite hide
// nothing. Lines with ends that are not finite give no pieces; neither does any line of a view without sense
// (numbers that are not finite, near <= 0, far <= near, no size).
class HiddenLines {
 public:
  HiddenLines();
  ~HiddenLines();
  HiddenLines(HiddenLines&&) noexcept;
  HiddenLines& operator=(HiddenLines&&) noexcept;

  // page_height: units; the page is as wide as the view's aspect says. Only triangles that are drawn hide:
  // backs of single-sided materials do not, nor do blended and alpha-tested materials, nor what the near
  // plane cuts off. A view or a page without a size that is a finite number above zero (pages: 1e-15 to
  // 1e15 units) has no visible lines. The scene's memory is not needed afterwards. Takes n log n time for n
  // triangles.
  void setView(const SceneView& scene, const View& view, double page_height);

  // Appends the pieces of the lines that lie in the view and that no triangle of the occluders hides. A line
  // that lies in a triangle's plane, or nearer to it than rounding tells, is not hidden by it. Pieces are in
  // the order of the lines, those of one line ascend; pieces of no length are left out; lines seen end on
  // give none. Occluders are put in a tree first: many lines a call are quicker than many calls. Allocates
  // nothing once it has grown, but for `pieces`.
  void visiblePieces(std::span<const FeatureLine> lines, std::span<const ObjectId> occluders,
                     std::vector<LinePiece>& pieces);

  const HiddenLineStats& stats() const;  // since setView()

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
