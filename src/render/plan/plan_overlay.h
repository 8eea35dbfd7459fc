#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sightline/render/plan_view.h"

namespace sightline::render {

// A corner of a triangle over a plan view: position in clip space, colour with straight alpha.
struct OverlayVertex {
  float x, y;
  std::array<std::uint8_t, 4> color;
};

// The triangles drawn over a plan view, back to front: occluders, the frustum's outline and the eye.
std::vector<OverlayVertex> planOverlay(const PlanView& plan);

}  // namespace sightline::render
