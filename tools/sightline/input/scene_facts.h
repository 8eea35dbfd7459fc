#pragma once

// --method auto: counts in a loaded scene what the rules ask for, and replaces it by what they choose.

#include "tools/sightline/input/load.h"
#include "tools/sightline/methods/method_choice.h"

namespace sightline::tool {

// Counts what the rules of --method auto ask of a scene and a walk. Takes less than a second: of a large
// scene, it looks at some of the objects, and seeks occluders in the first triangles of each.
SceneFacts lookAt(const SceneAndWalk& input);

// The settings of a command along a walk, whose scene decides what --method auto stands for. checked: those
// of settingsOf(options), before the scene was known.
Result<std::vector<Setting>> settingsFor(const MethodOptions& options, std::vector<Setting> checked,
                                         const SceneAndWalk& input);

}  // namespace sightline::tool
