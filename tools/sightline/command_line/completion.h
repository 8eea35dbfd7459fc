#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace sightline::tool {

std::vector<std::string> shellNames();

// The script that completes commands, options, their words and files, from the declarations that --help
// prints. shell: one of shellNames.
std::string completionScript(const CLI::App& app, const std::string& shell);

}  // namespace sightline::tool
