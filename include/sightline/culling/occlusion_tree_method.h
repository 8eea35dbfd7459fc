#pragma once

#include <memory>

#include "sightline/culling/culling_method.h"
#include "sightline/occlusion/occlusion_tree.h"

namespace sightline {

struct OcclusionTreeMethodSettings {
  OcclusionTreeVariant variant = OcclusionTreeVariant::kFME;
  bool temporal_coherence = true;  // nodes that were partly visible in a frame are not tested in the next one
};

inline constexpr MethodTraits kOcclusionTreeTraits{.occluders = true};

// Culling by an OcclusionTree of the chosen occluders (Bittner, Havran, Slavik 1998).
// Statistics: "tree" with nodes, plane_tests, and dropped, the occluder fragments that found no room, which
// costs tightness, never correctness.
std::unique_ptr<CullingMethod> occlusionTree(const OcclusionTreeMethodSettings& settings = {});

}  // namespace sightline
