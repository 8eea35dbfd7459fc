#include "oracle/image_polygon.h"

#include <utility>

namespace sightline {

ImagePolygon rectangle(ImageFigures& figures, const ImageRectangle& extents) {
  if (!(extents.x_min < extents.x_max && extents.y_min < extents.y_max)) {
    return {};
  }
  const ImageSpace& space = figures.space();
  const Vec3d &right = space.right(), &up = space.up(), &forward = space.forward();
  ImagePolygon polygon;
  polygon.edges = {
      figures.lineGiven(up - forward * extents.y_min), figures.lineGiven(forward * extents.x_max - right),
      figures.lineGiven(forward * extents.y_max - up), figures.lineGiven(right - forward * extents.x_min)};
  for (std::size_t i = 0; i < 4; ++i) {
    polygon.corners.push_back(figures.intersection(polygon.edges[(i + 3) % 4], polygon.edges[i]));
  }
  return polygon;
}

DividedPolygon divide(ImageFigures& figures, const ImagePolygon& polygon, ImageFigures::Line line) {
  const std::size_t count = polygon.corners.size();
  std::vector<int> sides(count);
  bool has_positive = false, has_negative = false;
  for (std::size_t i = 0; i < count; ++i) {
    sides[i] = figures.side(line, polygon.corners[i]);
    has_positive = has_positive || sides[i] > 0;
    has_negative = has_negative || sides[i] < 0;
  }
  if (!has_positive || !has_negative) {
    return has_positive ? DividedPolygon{polygon, {}} : DividedPolygon{{}, polygon};
  }
  DividedPolygon parts;
  const auto add = [](ImagePolygon& part, ImageFigures::Corner corner, ImageFigures::Line edge) {
    part.corners.push_back(corner);
    part.edges.push_back(edge);
  };
  for (std::size_t i = 0; i < count; ++i) {
    const int from = sides[i], to = sides[(i + 1) % count];
    const ImageFigures::Line edge = polygon.edges[i];
    // A part that the border leaves at this corner goes on along the line.
    if (from >= 0) {
      add(parts.positive, polygon.corners[i], from == 0 && to < 0 ? line : edge);
    }
    if (from <= 0) {
      add(parts.negative, polygon.corners[i], from == 0 && to > 0 ? line : edge);
    }
    if (from * to < 0) {
      const ImageFigures::Corner crossing = figures.intersection(edge, line);
      add(parts.positive, crossing, from > 0 ? line : edge);
      add(parts.negative, crossing, from < 0 ? line : edge);
    }
  }
  return parts;
}

ImagePolygon clipped(ImageFigures& figures, ImagePolygon polygon, const ImageRegion& region) {
  for (const ImageFigures::Line line : region.lines) {
    if (polygon.empty()) {
      break;
    }
    polygon = divide(figures, polygon, line).positive;
  }
  return polygon;
}

ImagePolygon subtract(ImageFigures& figures, const ImagePolygon& polygon, const ImageRegion& region,
                      std::vector<ImagePolygon>& rest) {
  const std::size_t before = rest.size();
  ImagePolygon inside = polygon;
  for (const ImageFigures::Line line : region.lines) {
    DividedPolygon parts = divide(figures, inside, line);
    if (parts.positive.empty()) {
      rest.resize(before);
      return {};
    }
    if (!parts.negative.empty()) {
      rest.push_back(std::move(parts.negative));
    }
    inside = std::move(parts.positive);
  }
  return inside;
}

}  // namespace sightline
