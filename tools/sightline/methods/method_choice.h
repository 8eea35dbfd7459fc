#pragma once

// --method auto: which method a scene gets, by rules about what a look at the scene counts. docs/using.md has
// the measurements on which the rules rest.

#include <string>
#include <utility>
#include <vector>

#include "tools/sightline/command_line/json_output.h"
#include "tools/sightline/methods/setting.h"

namespace sightline::tool {

// The word that stands for the choice on the command line.
inline constexpr const char* kAutomaticMethod = "auto";

// What the rules know of a scene. All of it is counted, so that the same scene and walk give the same choice.
struct SceneFacts {
  double see_through = 0.0;    // part of the triangles that are blended or alpha-tested: glass, foliage
  double occluder_area = 0.0;  // area of the polygons that can hide, over the surface of the scene's box
  double in_frustum = 0.0;     // objects in the view frustum, mean over some frames of the walk
  bool baked = false;          // there are baked sets
};

struct MethodChoice {
  SceneFacts facts;
  std::string method;
  // Options of the method that differ from its defaults, by names without "--". The user's own come first.
  std::vector<std::pair<std::string, std::string>> options{};
  std::string why;  // a sentence without its full stop
};

MethodChoice chooseMethod(const SceneFacts& facts);

// Adds "chosen", what was counted and why, if the setting is one that --method auto stands for.
void addChoice(Json& json, const Setting& setting);
// Which method --method auto stands for, and why, as a line; empty if none of the settings is chosen.
std::string choiceText(const std::vector<Setting>& settings);

}  // namespace sightline::tool
