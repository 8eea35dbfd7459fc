#pragma once

#include <string>

namespace CLI {
class App;
}

namespace sightline::tool {

// What was asked for, as it can be typed again: the words without a name, then the options that were given.
std::string commandLine(const CLI::App& command);

}  // namespace sightline::tool
