#pragma once

// The options of `bake`, and what they mean for the library.

#include <cstdint>
#include <string>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/pvs/bake/bake.h"
#include "tools/sightline/command_line/options.h"
#include "tools/sightline/methods/method_options.h"

namespace sightline::tool {

struct BakeOptions {
  CommonOptions common;
  std::string output;
  BakeSettings settings{};  // but for what depends on the scene or the threads:
  std::string region;       // six numbers, world space; empty: the scene's bounds
  std::uint32_t sample_mib = 1024;
  std::string databases;  // names, separated by commas
  bool resume = false, restart = false;
  bool force = false;  // to write over a file that is no baked one

  std::string partsFile() const { return output + ".parts"; }
};
void addBakeOptions(CLI::App& command, BakeOptions& options);

// Names of kBakedDatabases, in their order, each once.
Result<std::vector<std::string>> databaseNames(const BakeOptions& options);

// What is wrong with the options whatever the scene is.
Status checkOptions(const BakeOptions& options);

// For a scene. Precondition: checkOptions.
BakeSettings bakeSettings(const BakeOptions& options, const Scene& scene);

// What BakeRecord::settings holds: what the parts depend on, the scene's origin, so that points in world
// space can be asked for, and which occluders there were. Not the threads, nor what bounds their memory.
Json settingsJson(const Bake& bake, const Vec3d& origin);

}  // namespace sightline::tool
