#pragma once

// sightline verify --baked FILE --proof: tries to contradict what a baked file says of its cells.

#include <cstdint>
#include <string>

#include "sightline/base/result.h"
#include "tools/sightline/command_line/options.h"
#include "tools/sightline/commands.h"
#include "tools/sightline/methods/method_options.h"

namespace CLI {
class App;
}

namespace sightline::tool {

struct RegionOptions {
  std::uint32_t pairs = 2000;
  std::uint32_t seed = 1;
};
void addRegionOptions(CLI::App& command, RegionOptions& options);

// True if the command line asks for the cells of a baked file instead of a camera path: it has --baked and
// --proof, and no option that is about a path, methods or rays. Error if it has options of both.
Result<bool> asksForRegions(const CLI::App& command);

// Samples pairs of a cell and an object that the file calls hidden from it, and searches an eye in the cell
// that sees the object. Exit code 1 if one is found.
Result<ExitCode> verifyRegions(const CommonOptions& common, const MethodOptions& method,
                               const RegionOptions& options);

}  // namespace sightline::tool
