#pragma once

// What every output says of cracks that count as closed.

#include <string>

#include "sightline/pvs/format/baked_visibility.h"
#include "tools/sightline/command_line/json_output.h"

namespace sightline::tool {

// Metres; zeros: all are open.
struct CrackNote {
  double width = 0.0;  // --crack-width
  double slack = 0.0;  // how far closing moved a point at most
};
// " --crack-width 0.001", after the scene's name; empty for a width of 0.
std::string crackText(const CrackNote& note);
// Adds "crack_width" and "crack_slack" to a scene's object, unless the width is 0.
void addCracks(Json& scene, const CrackNote& note);
// What a baked file says of the scene that it was baked from.
CrackNote cracksOf(const BakeRecord& record);

}  // namespace sightline::tool
