#include "tools/sightline/commands.h"

namespace sightline::tool {

void addCommands(CLI::App& app, Command& chosen) {
  addInfo(app, chosen);
  addWalk(app, chosen);
  addCull(app, chosen);
  addVerify(app, chosen);
  addReproduce(app, chosen);
  addBake(app, chosen);
  addQuery(app, chosen);
  addLayers(app, chosen);
  addFrontDoor(app, chosen);
}

}  // namespace sightline::tool
