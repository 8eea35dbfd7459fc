// Based on: Poon, Wang. Occlusion Culling Using Minimum Occluder Set and Opacity Map. IV 1999, sections 4 and
// 6.1.

#include "src/comparison/occluders/viewpoint_lists.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace sightline::comparison {
namespace {

constexpr double kNearOfExtent = 0x1p-14;  // near distance of a picture, of the scene's diagonal

double nearDistance(const Hierarchy& hierarchy) {
  if (hierarchy.nodes.empty() || !hierarchy.nodes[0].bounds.wellFormed()) {
    return 0.1;
  }
  const Vec3d size(hierarchy.nodes[0].bounds.extent());
  return std::clamp(length(size) * kNearOfExtent, 1e-6, 1e6);
}

}  // namespace

PictureSource::PictureSource(const Hierarchy& hierarchy_, const OccluderSet& set_,
                             const ViewpointDatabaseSettings& settings_)
    : hierarchy(hierarchy_),
      set(set_),
      filter(set_),
      settings(settings_),
      shape{settings_.resolution, settings_.view_angle_deg, nearDistance(hierarchy_)} {
  if (settings.criterion == OccluderCriterion::kMinimumSets) {
    occludees = findOccludees(hierarchy, settings.min_triangles, settings.max_triangles);
  }
}

// A small patch at the angle a from the picture's middle has cos^3(a) times the solid angle that a patch of
// the same image has in the middle; a is largest in the corners.
double PictureSource::minSolidAngle() const {
  const double t = std::tan(shape.view_angle_deg * std::numbers::pi / 360.0);
  const double pixel = 2.0 * t / shape.resolution;
  const double to_corner = std::sqrt(1.0 + 2.0 * t * t);
  return settings.min_occluder_pixels * pixel * pixel / (to_corner * to_corner * to_corner);
}

void ListMaker::moveTo(const Vec3d& eye) {
  eye_ = eye;
  source_.filter.find(eye, source_.minSolidAngle(), candidates_);
}

void ListMaker::make(const Vec3d& direction, std::vector<OccluderId>& list) {
  list.clear();
  picture_.draw(source_.set, candidates_, eye_, direction, source_.shape,
                source_.settings.min_occluder_pixels);
  switch (source_.settings.criterion) {
    case OccluderCriterion::kProjectedSize:
      return byProjectedSize(list);
    case OccluderCriterion::kFirstHit:
      return byFirstHit(list);
    case OccluderCriterion::kMinimumSets:
      return byMinimumSets(list);
  }
}

// The list from the occluders in order_, which ascend: those with the largest key(number) first.
template <typename Key>
void ListMaker::rankBy(Key&& key, std::vector<OccluderId>& list) {
  std::stable_sort(order_.begin(), order_.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return key(a) > key(b); });
  order_.resize(std::min<std::size_t>(order_.size(), source_.settings.occluder_count));
  for (const std::uint32_t o : order_) {
    list.push_back(picture_.occluders()[o].id);
  }
}

void ListMaker::byProjectedSize(std::vector<OccluderId>& list) {
  order_.resize(picture_.occluders().size());
  std::iota(order_.begin(), order_.end(), 0u);
  rankBy([this](std::uint32_t o) { return picture_.occluders()[o].area; }, list);
}

void ListMaker::byFirstHit(std::vector<OccluderId>& list) {
  drawNearest();
  order_.clear();
  for (std::uint32_t o = 0; o < picture_.occluders().size(); ++o) {
    if (nearest_.pixelsOf(o) > 0) {
      order_.push_back(o);
    }
  }
  rankBy([this](std::uint32_t o) { return nearest_.pixelsOf(o); }, list);
}

void ListMaker::drawNearest() {
  nearest_.clear(picture_);
  for (std::uint32_t o = 0; o < picture_.occluders().size(); ++o) {
    nearest_.draw(picture_, o);
  }
}

void ListMaker::byMinimumSets(std::vector<OccluderId>& list) {
  const ViewpointDatabaseSettings& settings = source_.settings;
  const auto shown = picture_.occluders();
  occludeesInPicture(source_.hierarchy, source_.occludees, picture_.view(), picture_.resolution(),
                     occludees_);
  drawNearest();
  costsOf(picture_, settings.weights, cost_of_);
  stack_.build(picture_, nearest_, occludees_);
  pool_.clear();
  for (const std::uint32_t occludee : stack_.hidden()) {
    stack_.tableOf(occludees_[occludee], table_);
    for (const MinimumSet& found :
         search_.find(table_, cost_of_, {settings.sets_per_occludee, settings.search_limit})) {
      pool_.add(found.members, occludee);
    }
  }
  pool_.finish(static_cast<std::uint32_t>(shown.size()), static_cast<std::uint32_t>(occludees_.size()));
  for (const std::uint32_t occluder :
       selection_.select(picture_, pool_, occludees_, settings.weights, settings.occluder_count)) {
    list.push_back(shown[occluder].id);
  }
  if (settings.first_hit_after_sets) {
    goOnByFirstHit(list);
  }
}

void ListMaker::goOnByFirstHit(std::vector<OccluderId>& list) {
  std::vector<OccluderId> by_first_hit, known(list);
  std::sort(known.begin(), known.end());
  byFirstHit(by_first_hit);
  for (const OccluderId occluder : by_first_hit) {
    if (list.size() < source_.settings.occluder_count &&
        !std::binary_search(known.begin(), known.end(), occluder)) {
      list.push_back(occluder);
    }
  }
}

}  // namespace sightline::comparison
