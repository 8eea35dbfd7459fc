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
// Rounding. Camera points are off by some 2^-51 of their distance from the eye; |X| is that distance,
// interpolated between the ends of the line (all sizes are L1 norms). Take p for the nearer corner of an
// edge.
//   - In perspective (p x q) . X is computed as (p x (q - p)) . X. It is off by less than 2^-48 of
//     |p| |q - p| |X|: in the image, by an angle of 2^-48 / sin(angle between the edge and the sight to p).
//   - In an orthographic view (q - p) x (X - p) is computed, both on the screen. It is off by less than 2^-48
//     of |q - p| times the largest of |p|, |q| and |X|: by 2^-48 of that distance on the screen.
// Each edge is moved outwards by that, so that adjacent triangles leave no gap, also where a corner of one
// lies on an edge of another. No edge moves farther because another corner is far away.
//
// Corners are rounded to single precision, by up to 2^-24 of their largest coordinate in the scene, so a
// point nearer to the plane than 2^-21 of it, and 2^-46 of the distances from the eye, counts as in the
// plane. A line that begins or ends in the plane and is otherwise behind it is hidden up to the plane; a line
// that lies in the plane is not hidden.

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
