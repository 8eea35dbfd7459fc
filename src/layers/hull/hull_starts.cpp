#include "src/layers/hull/hull_starts.h"

#include "src/layers/hull/support.h"

namespace sightline::layers {
namespace {

// A direction through the middle of a cell.
Vec3d middleOf(std::size_t cell, const Vec3d& size) {
  constexpr std::array<double, kStartCells> kMiddles{-0.75, -0.25, 0.25, 0.75};
  const std::size_t side = cell / (kStartCells * kStartCells), main = side / 2;
  std::array<double, 3> d{};
  d[main] = side % 2 == 0 ? 1.0 : -1.0;
  d[(main + 1) % 3] = kMiddles[cell / kStartCells % kStartCells];
  d[(main + 2) % 3] = kMiddles[cell % kStartCells];
  return {d[0] / size.x, d[1] / size.y, d[2] / size.z};
}

}  // namespace

void findStarts(ConvexHull& hull) {
  hull.starts.clear();
  if (!climbs(hull)) {
    return;
  }
  Vec3d size;
  for (const Vec3d& vertex : hull.vertices) {
    size = max(size, abs(vertex - hull.centre));
  }
  const double largest = maxComponent(size);
  if (!(size.x > 0.0 && size.y > 0.0 && size.z > 0.0)) {
    return;
  }
  hull.start_size = size / largest;
  for (std::size_t cell = 0; cell < kStarts; ++cell) {
    hull.starts.push_back(farthestOfAll(hull, middleOf(cell, hull.start_size)).vertex);
  }
}

}  // namespace sightline::layers
