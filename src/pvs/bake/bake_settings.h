#pragma once

// Whether the settings of a bake are usable, and what tells one plan from another.

#include <cstdint>
#include <string>

#include "sightline/occluders/occluder_set.h"
#include "sightline/pvs/bake/bake.h"
#include "sightline/pvs/format/scene_id.h"

namespace sightline::pvs {

// What is wrong with the settings; empty if nothing is.
std::string problemWith(const BakeSettings& settings);

// A hash of all that the parts of a bake depend on. settings: complete, with the chosen depth.
std::uint64_t planHash(const SceneId& scene, const OccluderSet& occluders, const BakeSettings& settings,
                       std::uint32_t base_depth);

}  // namespace sightline::pvs
