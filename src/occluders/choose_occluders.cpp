#include "sightline/occluders/choose_occluders.h"

#include <algorithm>

#include "src/math/box_distance.h"
#include "src/scene/usable_view.h"

namespace sightline {
namespace {

bool insideFrustum(const Frustum& frustum, const OccluderSet& set, const Occluder& occluder) {
  for (const Plane& plane : frustum.planes) {
    bool any_inside = false;
    for (const Vec3f& vertex : set.verticesOf(occluder)) {
      any_inside |= plane.evaluate(Vec3d(vertex)) > 0.0;
    }
    if (!any_inside) {
      return false;
    }
  }
  return true;
}

// Whether the box around an occluder may intersect the frustum.
bool insideFrustum(const Frustum& frustum, const Box& box) {
  std::uint8_t cut = kAllFrustumPlanes;
  return classify(frustum, box, cut) != FrustumSide::kOutside;
}

Vec3d unitForward(const View& view) {
  Vec3d forward = view.forward;
  scene::makeUnit(forward);
  return forward;
}

// For a body, the sides of the box around it count.
double areaAngle(const Box& box, const View& view, AreaAngleDirection direction) {
  const Vec3d to_center = center(box) - view.eye;
  const double squared = view.orthographic ? 1.0 : dot(to_center, to_center);
  if (!(squared > 0.0)) {
    return 0.0;
  }
  const bool along_view = view.orthographic || direction == AreaAngleDirection::kView;
  const Vec3d v = abs(along_view ? unitForward(view) : to_center / std::sqrt(squared));
  const Vec3d size = Vec3d(box.max) - Vec3d(box.min);
  return (size.y * size.z * v.x + size.x * size.z * v.y + size.x * size.y * v.z) / squared;
}

}  // namespace

double areaAngle(const Occluder& occluder, const View& view, AreaAngleDirection direction) {
  const Vec3d to_center = Vec3d(occluder.centroid) - view.eye;
  const double facing =
      view.orthographic ? dot(occluder.plane.normal, unitForward(view)) : -occluder.plane.evaluate(view.eye);
  double sign = -1.0;
  if (facing >= 0.0) {
    if (!occluder.double_sided || facing == 0.0) {
      return 0.0;
    }
    sign = 1.0;
  }
  const double area = occluder.area;
  if (view.orthographic) {
    return std::max(0.0, sign * area * facing);
  }
  const double squared = dot(to_center, to_center);
  if (!(squared > 0.0)) {
    return 0.0;
  }
  const Vec3d v = direction == AreaAngleDirection::kView ? unitForward(view) : to_center / std::sqrt(squared);
  return std::max(0.0, sign * area * dot(occluder.plane.normal, v) / squared);
}

std::span<const OccluderId> OccluderChooser::choose(const View& view, const OccluderSet& set,
                                                    std::span<const ObjectId> objects,
                                                    std::span<const Box> object_bounds,
                                                    const ChoiceSettings& settings) {
  ranked_.clear();
  const double limit = settings.max_distance * settings.max_distance;
  for (const ObjectId object : objects) {
    if (limit > 0.0 && math::squaredDistance(object_bounds[object.value], view.eye) > limit) {
      continue;
    }
    for (const OccluderId id : settings.bodies ? set.unitsOf(object) : set.occludersOf(object)) {
      rank(view, set, id, settings);
    }
  }
  return takeBest(view, set, settings);
}

std::span<const OccluderId> OccluderChooser::choose(const View& view, const OccluderSet& set,
                                                    std::span<const OccluderId> candidates,
                                                    const ChoiceSettings& settings) {
  ranked_.clear();
  ChoiceSettings each = settings;
  each.bodies = false;
  for (const OccluderId id : candidates) {
    if (id.value < set.occluders.size()) {
      rank(view, set, id, each);
    }
  }
  return takeBest(view, set, each);
}

std::span<const OccluderId> OccluderChooser::takeFirst(const View& view, const OccluderSet& set,
                                                       std::span<const OccluderId> candidates,
                                                       std::uint32_t count) {
  chosen_.clear();
  const Frustum frustum = frustumOf(view);
  for (std::size_t i = 0; i < candidates.size() && chosen_.size() < count; ++i) {
    if (candidates[i].value >= set.occluders.size()) {
      continue;
    }
    const Occluder& occluder = set[candidates[i]];
    if (areaAngle(occluder, view, AreaAngleDirection::kOccluder) > 0.0 &&
        insideFrustum(frustum, set, occluder)) {
      chosen_.push_back(candidates[i]);
    }
  }
  return chosen_;
}

void OccluderChooser::rank(const View& view, const OccluderSet& set, OccluderId id,
                           const ChoiceSettings& settings) {
  const OccluderBody* body = settings.bodies ? set.bodyOf(id) : nullptr;
  const double score = body != nullptr ? areaAngle(body->bounds, view, settings.direction)
                                       : areaAngle(set[id], view, settings.direction);
  if (score > 0.0) {
    ranked_.emplace_back(score, id);
  }
}

std::span<const OccluderId> OccluderChooser::takeBest(const View& view, const OccluderSet& set,
                                                      const ChoiceSettings& settings) {
  chosen_.clear();
  const std::uint32_t count = settings.count;
  const auto better = [](const auto& a, const auto& b) {
    return a.first > b.first || (a.first == b.first && a.second < b.second);
  };
  // Best first; the frustum test is made only for those that come into question.
  const Frustum frustum = frustumOf(view);
  const auto inside = [&](OccluderId id) {
    const OccluderBody* body = settings.bodies ? set.bodyOf(id) : nullptr;
    return body != nullptr ? insideFrustum(frustum, body->bounds) : insideFrustum(frustum, set, set[id]);
  };
  auto begin = ranked_.begin();
  while (chosen_.size() < count && begin != ranked_.end()) {
    const auto wanted = static_cast<std::ptrdiff_t>(count - chosen_.size());
    const auto part = std::min(ranked_.end() - begin, std::max<std::ptrdiff_t>(2 * wanted, 32));
    std::nth_element(begin, begin + (part - 1), ranked_.end(), better);
    std::sort(begin, begin + part, better);
    for (auto it = begin; it != begin + part && chosen_.size() < count; ++it) {
      if (inside(it->second)) {
        chosen_.push_back(it->second);
      }
    }
    begin += part;
  }
  return chosen_;
}

}  // namespace sightline
