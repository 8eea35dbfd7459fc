#pragma once

// What the commands declare to the command line, for those who tell it: help, errors, manual, completion.

#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace sightline::tool {

// What `sightline --help` prints.
std::string overview(const CLI::App& app);

// The commands that --help lists, in its order.
std::vector<const CLI::App*> listedCommands(const CLI::App& app);
std::vector<std::string> commandNames(const CLI::App& app);

// Options that are given by name; words that are given by place.
std::vector<const CLI::Option*> namedOptions(const CLI::App& command);
std::vector<const CLI::Option*> positionals(const CLI::App& command);
// "-o", "--output": the ways to write it.
std::vector<std::string> spellings(const CLI::Option& option);
std::vector<std::string> allSpellings(const CLI::App& command);

bool isFlag(const CLI::Option& option);  // takes no value
// The type of value that the option takes: kFileType, kFolderType, "TEXT", "UINT", "FLOAT".
std::string typeOf(const CLI::Option& option);

}  // namespace sightline::tool
