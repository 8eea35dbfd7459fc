#pragma once

// Whether a scene that a program made by itself keeps the rules of SceneView.

#include "sightline/base/result.h"
#include "sightline/scene/scene.h"

namespace sightline {

// Checks the rules of SceneView, and that every vertex of an object is finite: others do no harm, but their
// objects are never culled, and importers refuse them. The error names the first object that breaks a rule,
// the rule, and the numbers that break it. Reads every index once; call it once a scene, at least while a
// program is developed: the other functions that take a SceneView do not check these rules.
Result<void> checkScene(const SceneView& scene);

}  // namespace sightline
