#pragma once

// Options that commands share, and what they mean for the library.

#include <CLI/CLI.hpp>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/culling/culler.h"

namespace sightline::tool {

using Json = nlohmann::ordered_json;

// What every command takes.
struct CommonOptions {
  std::string scene;
  std::string json;  // a file, "-" for stdout, empty for none
  std::uint32_t threads = 1;

  bool textOnStdout() const { return json != "-"; }
};
void addCommonOptions(CLI::App& command, CommonOptions& options);

// What commands take that walk a path.
struct PathOptions {
  std::string path;    // a file or the name of one of the scene's walks; empty: the default
  std::string frames;  // A:B[:STEP]; empty: all
};
void addPathOptions(CLI::App& command, PathOptions& options);

// The numbers of the frames that `text` (A:B[:STEP], or one number) chooses of `count`.
Result<std::vector<std::uint32_t>> chooseFrames(const std::string& text, std::size_t count);

// How to cull, as text; several values of an option are separated by commas.
struct MethodOptions {
  MethodOptions();  // the library's defaults

  std::string method, variant, occluder_count, hierarchy, coherence;  // lists
  std::string occluders, area_angle, test_objects;
  std::uint32_t min_node_cost;
  double lambda_steps;
};
void addMethodOptions(CLI::App& command, MethodOptions& options, bool lists);

// One method with one value of each option.
struct Setting {
  HierarchyKind hierarchy = HierarchyKind::kBvh;
  CullerSettings culler;
};
// All combinations, in the order of the lists; options that a method does not have do not multiply it.
Result<std::vector<Setting>> settingsOf(const MethodOptions& options);

std::string methodName(const Setting& setting);
std::string optionsText(const Setting& setting);  // for people: "FME, 64 occluders, bvh, coherence on"
Json optionsJson(const Setting& setting);

}  // namespace sightline::tool
