#pragma once

// The papers that can be reproduced.

#include <string>
#include <utility>
#include <vector>

#include "tools/sightline/reproduce/reproduction.h"

namespace sightline::tool {

struct Paper {
  const char* title;
  std::vector<std::string> scenes;  // unless the user names others; empty if the paper makes its own
  Result<Reproduction> (*reproduce)(const ReproduceOptions&, const std::vector<SceneAndWalk>&);
  bool bakes = false;
  std::vector<std::string> short_scenes{};  // the scenes with --short; empty: the same

  bool makesItsScenes() const { return scenes.empty(); }
  // The scenes that the options name, or the paper's.
  const std::vector<std::string>& scenesFor(const ReproduceOptions& options) const {
    return !options.scenes.empty()                         ? options.scenes
           : options.fewer_frames && !short_scenes.empty() ? short_scenes
                                                           : scenes;
  }
};

// All papers with their names on the command line, in alphabetical order. Each has its function in papers.h.
const std::vector<std::pair<std::string, Paper>>& papers();
std::vector<std::string> paperNames();
// Precondition: name is one of paperNames().
const Paper& findPaper(const std::string& name);

}  // namespace sightline::tool
