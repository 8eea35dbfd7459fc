#pragma once

#include <memory>

#include "sightline/culling/culling_method.h"

namespace sightline {

inline constexpr MethodTraits kVisibilityOctreeTraits{
    .occluders = false, .sets = SetUse::kAlways, .hierarchy = false};

// The potentially visible set of the eye's cell, as far as it intersects the frustum (Saona-Vazquez, Navazo,
// Brunet 1999). It needs CullingScene::sets and the objects' boxes, and neither occluders nor a hierarchy:
// the bake has done their work. Where the sets know nothing, all objects that intersect the frustum are kept,
// which a hierarchy makes faster.
std::unique_ptr<CullingMethod> visibilityOctree();

}  // namespace sightline
