#pragma once

// Records what hides objects from cells, if the settings ask for it.

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "sightline/pvs/format/witness.h"
#include "src/pvs/bake/bake_scene.h"
#include "src/pvs/bake/convex/convex_search.h"
#include "src/pvs/bake/object_mask.h"
#include "src/pvs/bake/surfaces/node_occlusion.h"

namespace sightline::pvs {

class WitnessRecorder {
 public:
  // The scene must outlive the recorder.
  explicit WitnessRecorder(const BakeScene& scene) : scene_(scene) {}

  // All that follows is about the cell of this number, and this part of it.
  void startCell(std::uint64_t number) { cell_ = number; }
  void startPart(WitnessPart part) { part_ = part; }

  // An occluder hides these objects. Those that are known to be hidden already are left out.
  void addConvex(std::uint32_t occluder, std::span<const ObjectRun> objects, const ObjectMask& known);
  void addFound(std::span<const ConvexSearch::Found> found, const ObjectMask& known);
  // The surfaces have just answered that they hide these objects.
  void addSurfaces(NodeOcclusion& surfaces, const ObjectRun& objects, const ObjectMask& known);

  // Forgets what hides objects from the sides of the last cell's plane.
  void forgetSides();
  // What was recorded since the last call.
  std::vector<HidingWitness> take() { return std::exchange(witnesses_, {}); }

 private:
  void add(HidingWitness witness, std::span<const ObjectRun> objects, const ObjectMask& known);

  const BakeScene& scene_;
  std::uint64_t cell_ = 1;
  WitnessPart part_ = WitnessPart::kWhole;
  std::vector<HidingWitness> witnesses_;
};

}  // namespace sightline::pvs
