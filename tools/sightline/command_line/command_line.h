#pragma once

#include <string>

namespace CLI {
class App;
}

namespace sightline::tool {

// The command line that was given, as it can be typed again: positional words first, then the options.
std::string commandLine(const CLI::App& command);

}  // namespace sightline::tool
