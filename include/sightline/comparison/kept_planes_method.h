#pragma once

#include <memory>

#include "sightline/comparison/kept_planes.h"
#include "sightline/culling/culling_method.h"

namespace sightline {

inline constexpr MethodTraits kKeptPlanesTraits{.occluders = true};

// Culling by the supporting and separating planes of each occluder and box, kept from frame to frame (Coorg,
// Teller 1997): the paper's form of supportingPlanes(), which is faster.
// Statistics: "relations" with reused, unchanged, rebuilt, evicted, dropped, kept and bytes, see
// RelationStats.
std::unique_ptr<CullingMethod> keptPlanes(const KeptPlanesSettings& settings = {});

}  // namespace sightline
