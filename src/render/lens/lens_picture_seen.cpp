#include "src/render/lens/lens_picture_seen.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "src/render/lens/depth_of_field_circle.h"

namespace sightline::render {

SeenLayer lookAt(const LayerImage& image, const View& view, const Lens& lens) {
  SeenLayer seen;
  double min_depth = std::numeric_limits<double>::infinity(), max_depth = 0.0;
  double weight = 0.0, x = 0.0, y = 0.0, inverse = 0.0, depths = 0.0;
  for (std::size_t i = 0; i < image.depths.size(); ++i) {
    const double alpha = static_cast<double>(image.pixels[i].alpha);
    const double depth = static_cast<double>(image.depths[i]);
    if (!(alpha > 0.0) || !std::isfinite(depth) || !std::isfinite(alpha)) {
      continue;
    }
    min_depth = seen.empty ? depth : std::min(min_depth, depth);
    max_depth = seen.empty ? depth : std::max(max_depth, depth);
    seen.empty = false;
    weight += alpha;
    const std::size_t row = i / image.width, column = i % image.width;
    x += alpha * (static_cast<double>(column) + 0.5);
    y += alpha * (static_cast<double>(row) + 0.5);
    inverse += alpha / depth;
    depths += alpha * depth;
  }
  if (seen.empty) {
    return seen;
  }
  seen.x = x / weight;
  seen.y = y / weight;
  // The circle of confusion is linear in the depth (perspective: in 1 / depth), so its mean is that of the
  // mean depth.
  seen.depth = view.orthographic ? depths / weight : weight / inverse;
  seen.min_circle = signedCircle(view, lens, min_depth, image.height);
  seen.max_circle = signedCircle(view, lens, max_depth, image.height);
  seen.mean_circle = signedCircle(view, lens, seen.depth, image.height);
  return seen;
}

}  // namespace sightline::render
