// bin/sightline-walk: the program with the command `walk` alone, which is built in a third of the time.

#include "tools/sightline/command_line/run_command_line.h"

int main(int argc, char** argv) {
  return sightline::tool::runCommandLine(argc, argv, sightline::tool::addWalk);
}
