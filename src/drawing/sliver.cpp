#include "src/drawing/sliver.h"

#include <cmath>

#include "src/drawing/clipper_paths.h"

namespace sightline::drawing {
namespace {

double meanWidth(const GridPath& ring) {
  double area = 0.0, perimeter = 0.0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const GridPoint& a = ring[i];
    const GridPoint& b = ring[i + 1 < ring.size() ? i + 1 : 0];
    const auto ax = static_cast<double>(a.x - ring[0].x), ay = static_cast<double>(a.y - ring[0].y);
    const auto bx = static_cast<double>(b.x - ring[0].x), by = static_cast<double>(b.y - ring[0].y);
    area += 0.5 * (ax * by - ay * bx);
    perimeter += std::hypot(bx - ax, by - ay);
  }
  return perimeter > 0.0 ? 2.0 * std::abs(area) / perimeter : 0.0;
}

// Whether something is left of a ring if its borders move inwards. True if Clipper fails.
bool hasInside(const GridPath& ring, double distance) {
  ClipperLib::Paths inside;
  const bool is_known = clipSafely([&] {
    ClipperLib::ClipperOffset offset;
    offset.AddPath(clipperPath(ring), ClipperLib::jtRound, ClipperLib::etClosedPolygon);
    offset.Execute(inside, -distance);
    return true;
  });
  return !is_known || !inside.empty();
}

}  // namespace

// The mean width of a convex ring is at least the radius of any circle in it, so that alone would do for
// those. In other rings a long sliver outweighs a wide piece that hangs on it.
bool isSliver(const GridPath& ring, double width) {
  return meanWidth(ring) < width && !hasInside(ring, width);
}

}  // namespace sightline::drawing
