#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace sightline::tool {

// What was asked for, as it can be typed again: the words without a name, then the options that were given.
std::string commandLine(const CLI::App& command);

}  // namespace sightline::tool
