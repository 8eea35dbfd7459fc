#pragma once

// How to cull: the options of the command line, and what they mean for the library.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/culling/culler.h"

namespace CLI {
class App;
}

namespace sightline::tool {

using Json = nlohmann::ordered_json;

// One method with one value of each option.
struct Setting {
  HierarchyKind hierarchy = HierarchySettings{}.kind;
  CullerSettings culler{};
  OccluderDatabaseSettings database{};
  ViewpointDatabaseSettings viewpoints{};
  bool baked = false;  // there is a baked file

  bool usesDatabase() const;
  bool usesViewpoints() const;
  bool usesMap() const;      // of occluders, in pixels
  bool approximate() const;  // may cull what can be seen
  bool testsDetailObjects() const;
  bool usesVisibleSets() const;
  bool planesThroughBox() const;  // which are kept where temporal coherence is on
};

// The options as text, one for each option that there is; several values are separated by commas.
struct MethodOptions {
  MethodOptions();  // the library's defaults

  std::vector<std::string> texts;
  std::string baked;  // a .sight file; empty: none
};
void addMethodOptions(CLI::App& command, MethodOptions& options, bool lists);

// All combinations, in the order of the lists; options that a method does not have do not multiply it. Says
// on stderr which of the given ones no method has. An error where one of them needs a baked file and there is
// none.
Result<std::vector<Setting>> settingsOf(const MethodOptions& options);

// Of the choices that the viewpoint database serves.
OccluderCriterion criterionOf(OccluderChoice choice);

std::string methodName(const Setting& setting);
// For people: "FME, 64 occluders, bvh, coherence on", then what is not as usual.
std::string optionsText(const Setting& setting);
Json optionsJson(const Setting& setting);

}  // namespace sightline::tool
