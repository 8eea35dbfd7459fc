#pragma once

// Whether surfaces hide a node of the box tree from a region, or an object by each of its boxes.

#include <cstdint>

#include "src/pvs/bake/bake_scene.h"
#include "src/pvs/bake/region_occlusion.h"

namespace sightline::pvs {

// Use by one thread at a time.
class NodeOcclusion {
 public:
  // Both must outlive this.
  NodeOcclusion(const BakeScene& scene, const Panels& panels);

  // True only if no point of the node's box can be seen from any point of the region; for a leaf, no point of
  // its object.
  bool hides(std::uint32_t node, const CellBox& region);
  // What decided the last question that hides() answered with true.
  WitnessKind decidedBy() const { return decided_by_; }
  RegionOcclusion& questions() { return questions_; }

 private:
  bool hidesObject(const CellBox& region, const Box& bounds, ObjectId object);
  // object: FusedTarget::object
  bool hidesBox(const CellBox& region, const Box& box, std::uint32_t object, const RegionEffort& effort);

  const BakeScene& scene_;
  RegionOcclusion questions_;
  WitnessKind decided_by_ = WitnessKind::kSurfaces;
};

}  // namespace sightline::pvs
