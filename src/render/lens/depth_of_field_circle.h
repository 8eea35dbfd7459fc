#pragma once

// The circle of confusion with a sign, so that it can be averaged and its range taken across the focus.

#include <cstdint>

#include "sightline/render/depth_of_field.h"

namespace sightline::render {

// circleOfConfusion with a negative sign for depths before the plane of focus.
double signedCircle(const View& view, const Lens& lens, double depth, std::uint32_t height);

}  // namespace sightline::render
