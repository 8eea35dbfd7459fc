#pragma once

#include <vector>

#include "tools/sightline/methods/setting.h"

namespace sightline::tool {

// Returns the settings with view-frustum culling in front, with which the others are compared. If none of
// them is view-frustum culling, it is added.
std::vector<Setting> withBaseline(std::vector<Setting> settings);

}  // namespace sightline::tool
