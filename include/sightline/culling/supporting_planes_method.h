#pragma once

#include <memory>

#include "sightline/culling/culling_method.h"
#include "sightline/occlusion/supporting_planes.h"

namespace sightline {

inline constexpr MethodTraits kSupportingPlanesTraits{.occluders = true};

// Culling by SupportingPlanes of the chosen occluders: planes through the eye and their edges (Coorg, Teller
// 1997).
std::unique_ptr<CullingMethod> supportingPlanes(const SupportingPlanesSettings& settings = {});

}  // namespace sightline
