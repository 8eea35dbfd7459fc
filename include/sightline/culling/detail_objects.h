#pragma once

#include <cstdint>
#include <memory>

#include "sightline/culling/culling_method.h"
#include "sightline/occlusion/supporting_planes.h"

namespace sightline {

struct DetailObjectsSettings {
  std::uint32_t occluder_count = 8;  // at most so many for each object
  SupportingPlanesSettings planes{};
};

// The method, and then a second test of each object that it kept: whether the eye is hidden from the object
// by occluders near the object (CullingScene::near_objects). Boxes that move, and occluders that move, have
// no part in it. It takes the time CullStats::detail_us. It is a test for one eye, so each frame is culled
// for its own view alone, whatever CullerSettings::views_at_once is.
//
// Statistics: those of the method, and "detail" with tested and culled.
std::unique_ptr<CullingMethod> detailObjects(std::unique_ptr<CullingMethod> method,
                                             const DetailObjectsSettings& settings = {});

}  // namespace sightline
