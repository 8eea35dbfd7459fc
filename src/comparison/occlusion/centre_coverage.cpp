// Based on: Poon Chun Ho, W. Wang. Occlusion Culling Using Minimum Occluder Set and Opacity Map. 1999,
// section 5.

#include "sightline/comparison/centre_coverage.h"

#include <algorithm>

#include "src/occlusion/polygons/raster_rows.h"

namespace sightline {

using namespace occlusion;

namespace {

class CentreCoverage final : public CoverageRule {
 public:
  void draw(const BufferPolygons& polygons, std::span<const std::uint32_t> order,
            const RasterBand& band) const override {
    for (const std::uint32_t p : order) {
      drawPolygon(polygons, polygons.polygons[p], band);
    }
  }

 private:
  static void drawPolygon(const BufferPolygons& polygons, const BufferPolygon& polygon,
                          const RasterBand& band) {
    const ReciprocalDepthPlane& plane = polygon.planes[0];
    const double at_first_centre = plane.at_origin + 0.5 * (plane.along_x + plane.along_y);
    geometry::forEachCentreSpan(polygons.corners(polygon), band.width, band.end_row,
                                [&](std::uint32_t y, std::uint32_t first, std::uint32_t last) {
                                  if (y < band.first_row) {
                                    return;
                                  }
                                  float* row = band.reciprocal_depth + std::size_t{y} * band.stride;
                                  const double at_row = at_first_centre + plane.along_y * y;
                                  for (std::uint32_t x = first; x <= last; ++x) {
                                    row[x] = std::max(row[x], static_cast<float>(at_row + plane.along_x * x));
                                  }
                                });
  }
};

constexpr CentreCoverage kCentreCoverage;

}  // namespace

const CoverageRule* centreCoverage() {
  return &kCentreCoverage;
}

}  // namespace sightline
