#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sightline/render/plan_view.h"

namespace sightline::render {

// A corner of a triangle over a plan view: clip space and straight alpha.
struct OverlayVertex {
  float x, y;
  std::array<std::uint8_t, 4> color;
};

// The triangles, back to front, of what is drawn over a plan: occluders, the frustum's outline, the eye.
std::vector<OverlayVertex> planOverlay(const PlanView& plan);

}  // namespace sightline::render
