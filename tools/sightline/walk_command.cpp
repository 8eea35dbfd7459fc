#include "tools/sightline/commands.h"

namespace sightline::tool {

void addCommands(CLI::App& app, Command& chosen) {
  addWalk(app, chosen);
}

}  // namespace sightline::tool
