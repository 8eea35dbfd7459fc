#pragma once

#include <memory>

#include "sightline/culling/culling_method.h"

namespace sightline {

inline constexpr MethodTraits kFrustumTraits{.occluders = false, .sets = SetUse::kNever};

// View-frustum culling alone: objects whose boxes intersect the frustum are kept.
std::unique_ptr<CullingMethod> frustumCulling();

}  // namespace sightline
