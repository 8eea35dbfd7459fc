#pragma once

// What a Bake consists of; it does not change once the bake is planned.

#include <cstdint>
#include <optional>

#include "sightline/pvs/bake/bake.h"
#include "src/pvs/bake/bake_scene.h"

namespace sightline {

struct Bake::Data {
  Data(const SceneView& view, const OccluderSet& occluders, const BakeSettings& settings,
       const ParallelFor& parallel_for)
      : scene(view, occluders, settings, parallel_for), scene_id(sceneId(view)) {
    if (const std::uint64_t count = scene.mostLeaves({}, kMaxCounted + 1); count <= kMaxCounted) {
      max_cells = count;
    }
  }

  // How much of the bake a cell with all below it is, 0 to 1.
  double shareOf(const OctreeCell& cell) const;

  pvs::BakeScene scene;
  SceneId scene_id;
  std::optional<std::uint64_t> max_cells;  // Bake::maxCells
  std::uint64_t hash = 0;
};

}  // namespace sightline
