#pragma once

// From visible pieces of lines to strokes.

#include <array>
#include <cstdint>
#include <set>
#include <span>
#include <vector>

#include "sightline/drawing/drawing.h"
#include "sightline/drawing/hidden_lines.h"

namespace sightline::drawing {

// Joins pieces of one object where the ends of their lines, corners of the object, are visible: each corner
// breaks no more strokes than it must, and of several ways the straightest is taken. tolerance: page units by
// which a stroke may leave out corners; shorter strokes are left out. strokes: replaced. A stroke that closes
// ends with its first point.
void joinPieces(std::span<const LinePiece> pieces, double tolerance, std::vector<PagePath>& strokes);

// Leaves out points of an open or closed (first == last) polyline from which the line without them is no
// farther than tolerance. The first and the last point stay. Source: Zhao, Saalfeld. Linear-time
// sleeve-fitting polyline simplification algorithms. AutoCarto 1997.
void simplify(PagePath& line, double tolerance);

// The pieces of a drawing so far, by where they lie on the page.
class DrawnPieces {
 public:
  explicit DrawnPieces(double tolerance) : tolerance_(tolerance) {}  // page units

  // Takes out pieces that lie on one before from end to end, and remembers the others.
  void leaveNew(std::vector<LinePiece>& pieces);

 private:
  double tolerance_;
  std::set<std::array<std::int64_t, 4>> drawn_;  // both ends, in steps of the tolerance, the lesser first
};

}  // namespace sightline::drawing
