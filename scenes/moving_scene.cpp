#include "scenes/moving_scene.h"

namespace sightline {

LayerSorter makeSorter(const MovingScene& scene, const LayerSettings& settings) {
  LayerSorter sorter(settings);
  for (const ConvexHull& hull : scene.hulls) {
    sorter.addHull(hull);
  }
  for (const MovingPart& part : scene.parts) {
    const std::vector<HullId> hulls(part.hulls.begin(), part.hulls.end());
    sorter.addPart(hulls, part.settings);
  }
  for (const MovingPlane& plane : scene.planes) {
    sorter.setRule(PartId(plane.first), PartId(plane.second), plane.rule);
  }
  for (const MovingJoint& joint : scene.joints) {
    sorter.setRule(PartId(joint.first), PartId(joint.second), joint.rule);
  }
  return sorter;
}

void pose(const MovingScene& scene, std::uint32_t frame, std::vector<Mat4>& poses, LayerSorter& sorter) {
  if (!scene.pose) {
    return;
  }
  poses.resize(scene.parts.size());
  scene.pose(frame, poses);
  for (std::uint32_t part = 0; part < poses.size(); ++part) {
    sorter.setTransform(PartId(part), poses[part]);
  }
}

}  // namespace sightline
