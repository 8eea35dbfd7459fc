#pragma once

// Convex polygons of an image, and what is left of one when others are subtracted from it.

#include <vector>

#include "oracle/image_figures.h"

namespace sightline {

// Edge i goes from corner i to corner i + 1 along edges[i]; no two neighbouring edges are on the same line.
// Has an area unless it is empty.
struct ImagePolygon {
  std::vector<ImageFigures::Corner> corners;
  std::vector<ImageFigures::Line> edges;

  bool empty() const { return corners.empty(); }
};

// Empty unless both differences of the extents are positive.
ImagePolygon rectangle(ImageFigures& figures, const ImageRectangle& extents);

// The parts on both sides of a line; one of them is empty unless the line runs through the inside. If no
// direction is on either side, all of the polygon counts as negative.
struct DividedPolygon {
  ImagePolygon positive, negative;
};
DividedPolygon divide(ImageFigures& figures, const ImagePolygon& polygon, ImageFigures::Line line);

// What is on the positive side of all lines, borders included.
struct ImageRegion {
  std::vector<ImageFigures::Line> lines;
};

// The part of the polygon inside the region, with an area or empty.
ImagePolygon clipped(ImageFigures& figures, ImagePolygon polygon, const ImageRegion& region);

// Appends convex polygons to `rest` that, with the region, cover the polygon, and returns the part inside the
// region. If that has no area, it is empty and nothing is appended.
ImagePolygon subtract(ImageFigures& figures, const ImagePolygon& polygon, const ImageRegion& region,
                      std::vector<ImagePolygon>& rest);

}  // namespace sightline
