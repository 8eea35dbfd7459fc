#pragma once

// Joins visible pieces of lines to strokes.

#include <array>
#include <cstdint>
#include <set>
#include <span>
#include <vector>

#include "sightline/drawing/drawing.h"
#include "sightline/drawing/hidden_lines.h"

namespace sightline::drawing {

// Replaces `strokes` by the pieces of one object, joined at visible corners of the object. Each corner ends
// as few strokes as possible; of several ways to join, the straightest is taken. tolerance, in page units, is
// the distance by which a stroke may miss corners; shorter strokes are left out. A closed stroke ends with
// its first point.
void joinPieces(std::span<const LinePiece> pieces, double tolerance, std::vector<PagePath>& strokes);

// Simplifies an open or closed (first == last) polyline: drops points from which the remaining line is no
// farther than tolerance. The first and the last point stay. Source: Zhao, Saalfeld. Linear-time
// sleeve-fitting polyline simplification algorithms. AutoCarto 1997.
void simplify(PagePath& line, double tolerance);

// The pieces drawn so far, identified by their ends on the page.
class DrawnPieces {
 public:
  explicit DrawnPieces(double tolerance) : tolerance_(tolerance) {}  // page units

  // Removes pieces whose ends are those of an earlier piece, and remembers the others.
  void leaveNew(std::vector<LinePiece>& pieces);

 private:
  double tolerance_;
  std::set<std::array<std::int64_t, 4>> drawn_;  // both ends in steps of the tolerance, the smaller one first
};

}  // namespace sightline::drawing
