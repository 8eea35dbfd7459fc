// bin/sightline: the program with all commands.

#include "tools/sightline/command_line/run_command_line.h"

namespace sightline::tool {
namespace {

// Adds the commands in the order in which --help lists them.
void addAllCommands(CLI::App& app, Command& chosen) {
  addInfo(app, chosen);
  addWalk(app, chosen);
  addCull(app, chosen);
  addVerify(app, chosen);
  addBench(app, chosen);
  addReproduce(app, chosen);
  addBake(app, chosen);
  addCheck(app, chosen);
  addQuery(app, chosen);
  addLayers(app, chosen);
  addFrontDoor(app, chosen);
}

}  // namespace
}  // namespace sightline::tool

int main(int argc, char** argv) {
  return sightline::tool::runCommandLine(argc, argv, sightline::tool::addAllCommands);
}
