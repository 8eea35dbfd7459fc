#pragma once

// Whether surfaces hide a node of the box tree from a region, or an object by each of its boxes.

#include <cstdint>

#include "src/pvs/bake/bake_scene.h"
#include "src/pvs/bake/surfaces/region_occlusion.h"

namespace sightline::pvs {

// What the settings ask for, of a cell that is not divided any more.
inline RegionEffort effortOf(const BakeSettings& settings) {
  return {settings.narrowings, settings.divisions};
}

// Use by one thread at a time.
class NodeOcclusion {
 public:
  // Both must outlive this.
  NodeOcclusion(const BakeScene& scene, const Panels& panels);

  // True only if no point of the node's box can be seen from any point of the region; for a leaf, no point of
  // its object. effort: for leaves.
  bool hides(std::uint32_t node, const CellBox& region, const RegionEffort& effort);
  // What decided the last question that hides() answered with true.
  WitnessKind decidedBy() const { return decided_by_; }
  RegionOcclusion& questions() { return questions_; }

 private:
  bool hidesObject(const CellBox& region, const Box& bounds, ObjectId object, const RegionEffort& effort);
  // object: FusedTarget::object
  bool hidesBox(const CellBox& region, const Box& box, std::uint32_t object, const RegionEffort& effort);

  const BakeScene& scene_;
  RegionOcclusion questions_;
  WitnessKind decided_by_ = WitnessKind::kSurfaces;
};

}  // namespace sightline::pvs
