#pragma once

#include <string>

namespace CLI {
class App;
}

namespace sightline::tool {

// The manual page sightline.1 in the language of man(7), made from the declarations that --help prints.
std::string manualPage(const CLI::App& app);

}  // namespace sightline::tool
