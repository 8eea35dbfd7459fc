#pragma once

// What baked sets say about the instances of a World, for one view.

#include <cstdint>
#include <vector>

#include "sightline/occlusion/visible_sets.h"
#include "sightline/scene/camera.h"
#include "src/world/id_bits.h"
#include "src/world/world_data.h"

namespace sightline::world {

class EyeSets {
 public:
  // sets: null to use none from now on.
  void use(SetsId id, VisibleSets* sets);
  // Finds the sets of a view in world space. groups: those of the view.
  void find(const WorldData& data, const View& view, std::uint32_t groups);
  // Takes out of a set of instances what cannot be seen, as the last find() says.
  void restrict(const WorldData& data, IdBits& instances) const;

 private:
  struct Used {
    SetsId id;
    VisibleSets* sets = nullptr;
    std::uint64_t boxes = 0;    // hashOfBoxes() of the sets
    std::uint64_t version = 0;  // of the world's sets, when it was marked
    std::uint32_t set = VisibleSet::kEverything;
    bool everything = true;
    std::vector<std::uint8_t> marks;  // by ObjectId of the baked scene: it is in the set
  };
  static void mark(const BakedObjects& baked, const VisibleSet& set, Used& used);

  std::vector<Used> used_;
  bool restricts_ = false;
};

}  // namespace sightline::world
