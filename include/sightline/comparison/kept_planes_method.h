#pragma once

#include <memory>

#include "sightline/comparison/kept_planes.h"
#include "sightline/culling/culling_method.h"

namespace sightline {

inline constexpr MethodTraits kKeptPlanesTraits{.occluders = true};

// Culling by the supporting and separating planes of each occluder and box, kept from frame to frame (Coorg,
// Teller 1997): the paper's form of supportingPlanes(), which is faster.
// Statistics: "relations" with reused, unchanged, rebuilt, evicted, dropped, kept and bytes, see
// RelationStats, and node_pairs, the pairs of an occluder and a node of the hierarchy that were compared.
std::unique_ptr<CullingMethod> keptPlanes(const KeptPlanesSettings& settings = {});

}  // namespace sightline
