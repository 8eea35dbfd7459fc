#pragma once

// Finds the part of a line that a triangle hides.
//
// In camera space, with the eye at zero, a point X = a + t (b - a) is hidden by the triangle p, q, r if X is
//   - inside the pyramid of the eye and the edges (orthographic: the prism along z): (p x q) . X >= 0, and
//     likewise for the other edges,
//   - behind the plane: n . (X - p) > 0,
//   - beyond a part of the triangle that is drawn: the ray intersects it at the near plane or farther.
// Here p, q, r are turned so that n = (q - p) x (r - p) points away from the eye. All of these are linear in
// X, hence in t, also for triangles that reach behind the eye: nothing is clipped, and t is a share of the
// line in space.
//
// Rounding. Camera points are off by some 2^-51 of their distance, so (p x q) . X is off by less than 2^-48
// of |p| |q| |X|. The pyramid is widened by that, so that adjacent triangles leave no gap. Corners are
// rounded to single precision, by up to 2^-24 of their largest coordinate in the scene, so a point nearer to
// the plane than 2^-21 of it counts as in the plane. A line that begins or ends in the plane and is otherwise
// behind it is hidden up to the plane; a line that lies in the plane is not hidden.

#include <array>

#include "src/drawing/line_view.h"

namespace sightline::drawing {

struct HidingTriangle {
  std::array<Vec3d, 3> corners;  // camera space; turned as above
  double reach = 0.0;            // the largest magnitude of a corner, camera space
  double size = 0.0;             // the largest coordinate of a corner, scene space
};

// Turns the corners as above. False if the eye lies in the triangle's plane.
bool turnToEye(HidingTriangle& triangle, bool orthographic);

struct HidableLine {
  Vec3d a, b;                         // camera space
  double size_a = 0.0, size_b = 0.0;  // the largest coordinate of each end, scene space
  double from = 0.0, to = 1.0;        // the part within the view, as shares
};

// Finds the part of [line.from, line.to] that the triangle hides. False if it hides nothing.
bool hiddenPart(const HidingTriangle& triangle, const HidableLine& line, const View& view, double& from,
                double& to);

}  // namespace sightline::drawing
