#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace sightline::tool {

std::vector<std::string> shellNames();

// The script by which a shell (one of shellNames) completes commands, options, their words and files, made
// from the declarations that --help prints.
std::string completionScript(const CLI::App& app, const std::string& shell);

}  // namespace sightline::tool
