#include "src/comparison/occluders/occluder_filter.h"

#include <algorithm>
#include <cmath>

#include "src/occluders/occluder_radius.h"

namespace sightline::comparison {
namespace {

bool allFinite(const OccluderSet& set, const Occluder& occluder) {
  const auto vertices = set.verticesOf(occluder);
  return isFinite(occluder.centroid) && isFinite(occluder.plane.normal) &&
         std::isfinite(occluder.plane.offset) && std::isfinite(occluder.area) &&
         std::all_of(vertices.begin(), vertices.end(), [](const Vec3f& vertex) { return isFinite(vertex); });
}

// The height of the eye over a side of the occluder that hides; 0 when it sees none.
double heightOver(const Occluder& occluder, const Vec3d& eye) {
  const double height = occluder.plane.evaluate(eye);
  return height > 0.0 ? height : occluder.double_sided ? -height : 0.0;
}

}  // namespace

OccluderFilter::OccluderFilter(const OccluderSet& set) : set_(set) {
  for (std::uint32_t i = 0; i < set.occluders.size(); ++i) {
    const Occluder& occluder = set.occluders[i];
    if (allFinite(set, occluder)) {
      all_.push_back({OccluderId(i), occluders::radiusOf(set, occluder)});
    }
  }
}

void OccluderFilter::find(const Vec3d& eye, double min_solid_angle, std::vector<NearOccluder>& found) const {
  found.clear();
  for (const NearOccluder& candidate : all_) {
    const Occluder& occluder = set_[candidate.id];
    const double height = heightOver(occluder, eye);
    if (!(height > 0.0)) {
      continue;
    }
    const double gap = length(Vec3d(occluder.centroid) - eye) - candidate.radius;
    if (!(gap > 0.0) || occluder.area * height >= min_solid_angle * (gap * gap * gap)) {
      found.push_back(candidate);
    }
  }
}

}  // namespace sightline::comparison
