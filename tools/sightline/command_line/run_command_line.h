#pragma once

#include "tools/sightline/commands.h"

namespace sightline::tool {

// Adds the commands that a program has to its command line.
using AddCommands = void (*)(CLI::App& app, Command& chosen);

// What main() does: parses the words, runs the command that they name and returns the program's exit code.
// Whatever fails is one line on stderr. Throws nothing.
int runCommandLine(int argc, char** argv, AddCommands add_commands);

}  // namespace sightline::tool
