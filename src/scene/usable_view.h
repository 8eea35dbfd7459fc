#pragma once

#include "sightline/scene/camera.h"

namespace sightline {

// Prepares a caller's view for use, as validate() describes; allocates nothing, for every frame. Null, or
// what is wrong with the view, a text without end of life; the view is then as it was.
const char* makeUsable(View& view);

}  // namespace sightline
