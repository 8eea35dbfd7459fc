#include "src/render/lens/depth_of_field_circle.h"

#include <cmath>

namespace sightline::render {

// Seen from the lens point o, in a picture sheared so that the plane of focus stays in place, a point at
// depth z moves by o (1 / focus - 1 / z) on the plane at distance 1.
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
