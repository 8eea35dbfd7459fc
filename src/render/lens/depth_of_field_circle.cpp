#include "src/render/lens/depth_of_field_circle.h"

#include <cmath>

namespace sightline::render {

// Seen from a point o of the lens, what lies at depth z moves on the plane at distance 1 by
// o (1 / focus - 1 / z), sheared as the picture is to hold the plane of focus.
double signedCircle(const View& view, const Lens& lens, double depth, std::uint32_t height) {
  if (!(lens.aperture > 0.0) || !(lens.focus > 0.0) || std::isnan(depth)) {
    return 0.0;
  }
  double circle = 0.0;
  if (view.orthographic) {
    circle = lens.aperture * (depth / lens.focus - 1.0) / view.ortho_height;
  } else if (depth > 0.0) {
    circle = lens.aperture * (1.0 / lens.focus - 1.0 / depth) / (2.0 * view.tan_half_fovy);
  }
  circle *= height;
  return std::isnan(circle) ? 0.0 : circle;
}

}  // namespace sightline::render
