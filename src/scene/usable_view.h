#pragma once

#include "sightline/scene/camera.h"

namespace sightline {

// Normalises an axis unless it is of unit length up to single precision. False: it has no direction.
bool makeUnit(Vec3d& axis);

// Prepares a caller's view for use, as validate() describes; allocates nothing, for every frame. Null, or
// what is wrong with the view, a text without end of life; the view is then as it was.
const char* makeUsable(View& view);

}  // namespace sightline
