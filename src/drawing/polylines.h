#pragma once

// From visible pieces of lines to strokes.

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

}  // namespace sightline::drawing
