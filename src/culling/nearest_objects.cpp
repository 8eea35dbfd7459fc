#include "src/culling/nearest_objects.h"

#include <algorithm>

#include "src/math/box_distance.h"

namespace sightline::culling {
bool NearestObjects::find(const Frustum& frustum, const Vec3d& eye, const SetFilter* filter, std::size_t most,
                          std::vector<ObjectId>& out) {
  waiting_.clear();
  if (!hierarchy_.nodes.empty()) {
    add(0, kAllFrustumPlanes, frustum, eye, filter);
  }
  std::size_t count = 0;
  while (!waiting_.empty() && count < most) {
    const Waiting nearest = takeNearest();
    const NodeIndex node(nearest.node);
    if (!hierarchy_.nodes[nearest.node].leaf()) {
      add(hierarchy_.left(node).value, nearest.planes, frustum, eye, filter);
      add(hierarchy_.right(node).value, nearest.planes, frustum, eye, filter);
      continue;
    }
    for (const ObjectId object : hierarchy_.objectsBelow(node)) {
      std::uint8_t planes = nearest.planes;
      if ((filter == nullptr || filter->hasObject(object)) &&
          classify(frustum, object_bounds_[object.value], planes) != FrustumSide::kOutside) {
        count += found_.insert(object) ? 1 : 0;
      }
    }
  }
  found_.drainInto(out);
  return waiting_.empty();
}

bool NearestObjects::comesLater(const Waiting& a, const Waiting& b) {
  return a.distance > b.distance || (a.distance == b.distance && a.node > b.node);
}

// Adds a node, if something of it may be in the frustum.
void NearestObjects::add(std::uint32_t node, std::uint8_t planes, const Frustum& frustum, const Vec3d& eye,
                         const SetFilter* filter) {
  const Box& box = hierarchy_.nodes[node].bounds;
  if ((filter != nullptr && !filter->hasNode(node)) ||
      classify(frustum, box, planes) == FrustumSide::kOutside) {
    return;
  }
  waiting_.push_back({math::squaredDistance(box, eye), node, planes});
  std::push_heap(waiting_.begin(), waiting_.end(), comesLater);
}

NearestObjects::Waiting NearestObjects::takeNearest() {
  std::pop_heap(waiting_.begin(), waiting_.end(), comesLater);
  const Waiting nearest = waiting_.back();
  waiting_.pop_back();
  return nearest;
}

}  // namespace sightline::culling
