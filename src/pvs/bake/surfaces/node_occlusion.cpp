#include "src/pvs/bake/surfaces/node_occlusion.h"

#include <algorithm>

namespace sightline::pvs {

NodeOcclusion::NodeOcclusion(const BakeScene& scene, const Panels& panels)
    : scene_(scene),
      questions_(panels, scene.settings.near_distance, scene.magnitude,
                 isThorough(scene.settings) ? FusedOcclusion::kMostRepeats : 0) {}

bool NodeOcclusion::hides(std::uint32_t number, const CellBox& region, const RegionEffort& effort) {
  const BoxTreeView boxes = scene_.boxes.view();
  const BoxNode& node = boxes.nodes[number];
  return boxes.leaf(number) ? hidesObject(region, node.bounds, boxes.objects[node.first_object], effort)
                            : hidesBox(region, node.bounds, kNoObject, {});
}

bool NodeOcclusion::hidesObject(const CellBox& region, const Box& bounds, ObjectId object,
                                const RegionEffort& effort) {
  const std::span<const Box> several = scene_.object_boxes.of(object);
  if (several.empty() || !areBoxesOf(several, bounds)) {
    return hidesBox(region, bounds, object.value, effort);
  }
  if (hidesBox(region, bounds, object.value, {})) {
    return true;
  }
  const bool hidden = std::all_of(several.begin(), several.end(), [&](const Box& box) {
    return hidesBox(region, box, object.value, effort);
  });
  decided_by_ = WitnessKind::kBoxes;
  return hidden;
}

bool NodeOcclusion::hidesBox(const CellBox& region, const Box& box, std::uint32_t object,
                             const RegionEffort& effort) {
  const bool hidden =
      box.wellFormed() && !intersects(region, box) &&
      questions_.hides(region, {.box = {Vec3d(box.min), Vec3d(box.max)}, .object = object}, effort);
  decided_by_ = questions_.decidedBy();
  return hidden;
}

}  // namespace sightline::pvs
