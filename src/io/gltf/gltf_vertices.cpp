#include "src/io/gltf/gltf_vertices.h"

#include <cmath>

namespace sightline::io {
namespace {

// The mean of where its joints take a point, by weight. Weights that do not add up to 1 are divided by their
// sum: so does the perspective division of renderers that add up matrices.
Result<Vec3d> placeByJoints(const Document& document, const PrimitiveSource& source,
                            const Placement& placement, std::uint64_t index, const Vec3d& point) {
  Vec3d sum;
  double weights = 0.0;
  for (std::size_t set = 0; set < source.joints.size(); ++set) {
    for (int i = 0; i < 4; ++i) {
      const double weight = source.weights[set]->number(index, i);
      if (!(weight >= 0.0) || !std::isfinite(weight)) {
        return failure("{}: {}: weight {} of vertex {} is negative or not finite", document.name,
                       source.where, weight, index);
      }
      if (weight == 0.0) {
        continue;
      }
      const auto joint = static_cast<std::size_t>(source.joints[set]->number(index, i));
      if (joint >= placement.joints.size()) {
        return failure("{}: node {}: {}: joint {} of vertex {} is out of range (its skin has {})",
                       document.name, placement.node, source.where, joint, index, placement.joints.size());
      }
      sum += transformPoint(placement.joints[joint], point) * weight;
      weights += weight;
    }
  }
  if (weights == 0.0) {
    return failure("{}: {}: no joint of its skin places vertex {}: its weights are all 0", document.name,
                   source.where, index);
  }
  return sum / weights;
}

}  // namespace

Result<Vec3d> placeVertex(const Document& document, const PrimitiveSource& source, const Placement& placement,
                          std::uint64_t index) {
  Vec3d point = source.positions->vector(index);
  for (const ActiveTarget& target : placement.targets) {
    if (target.number < source.targets.size() && source.targets[target.number] != nullptr) {
      point += source.targets[target.number]->vector(index) * target.weight;
    }
  }
  if (!isFinite(point)) {
    return failure("{}: {}: vertex {} of accessor {} is not finite", document.name, source.where, index,
                   source.position_accessor);
  }
  Result<Vec3d> point_world = placement.joints.empty()
                                  ? Result<Vec3d>(transformPoint(placement.world_from_node, point))
                                  : placeByJoints(document, source, placement, index, point);
  if (point_world && !SceneBuilder::inRange(*point_world)) {
    return failure("{}: node {}: {}: the world position of vertex {} exceeds single precision", document.name,
                   placement.node, source.where, index);
  }
  return point_world;
}

}  // namespace sightline::io
