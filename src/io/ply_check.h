#pragma once

#include <string>
#include <string_view>

#include "sightline/base/result.h"

namespace sightline::io {

// An error where Assimp would make other triangles of a .ply than it holds. Of a file that is cut off, it
// reads on past the end and makes triangles of what is not there; of triangle strips, it takes one triangle
// each.
Status checkPly(std::string_view bytes, const std::string& name);

// Whether its faces say how opaque they are, which Assimp does not hand over.
bool plyFacesHaveAlpha(std::string_view bytes);

}  // namespace sightline::io
