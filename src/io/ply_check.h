#pragma once

#include <string>
#include <string_view>

#include "sightline/base/result.h"

namespace sightline::io {

// Whether a .ply holds all the elements that its header announces. Assimp reads on past the end of a file
// that is cut off and makes triangles of what is not there.
Status checkPlyIsWhole(std::string_view bytes, const std::string& name);

}  // namespace sightline::io
