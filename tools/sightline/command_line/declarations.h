#pragma once

// The commands' declarations, for everything that is made from them: help, errors, manual, completion.

#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace sightline::tool {

// The text of `sightline --help`.
std::string overview(const CLI::App& app);

// The commands that --help lists, in its order.
std::vector<const CLI::App*> listedCommands(const CLI::App& app);
std::vector<std::string> commandNames(const CLI::App& app);

// Options are given by their names, positionals by their places.
std::vector<const CLI::Option*> namedOptions(const CLI::App& command);
std::vector<const CLI::Option*> positionals(const CLI::App& command);
// The ways to write an option: "-o", "--output".
std::vector<std::string> spellings(const CLI::Option& option);
std::vector<std::string> allSpellings(const CLI::App& command);

bool isFlag(const CLI::Option& option);  // takes no value
// The type of the option's value: kFileType, kFolderType, "TEXT", "UINT" or "FLOAT".
std::string typeOf(const CLI::Option& option);

}  // namespace sightline::tool
