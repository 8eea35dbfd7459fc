#pragma once

#include "sightline/scene/camera.h"

namespace sightline::scene {

// Normalises an axis unless it has unit length up to single precision. Returns false if it has no direction.
bool makeUnit(Vec3d& axis);

// Prepares a caller's view as validate() describes; allocates nothing, so it can run in every frame. Returns
// null, or a static text that says what is wrong with the view, which is then unchanged.
const char* makeUsable(View& view);

}  // namespace sightline::scene
