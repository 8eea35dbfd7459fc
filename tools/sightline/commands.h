#pragma once

// The commands. Each function adds a command to the command line; the one that the user names becomes
// `chosen`.

#include <functional>
#include <string>

#include "sightline/base/result.h"

namespace CLI {
class App;
}

namespace sightline::tool {

// A command that ran exits with kOk or kCheckFailed, or with interruptedExitCode() if it was told to end. An
// Error becomes kBadUsage and one line on stderr.
enum ExitCode : int { kOk = 0, kCheckFailed = 1, kBadUsage = 2 };

using Command = std::function<Result<ExitCode>()>;

void addInfo(CLI::App& app, Command& chosen);
void addWalk(CLI::App& app, Command& chosen);
void addCull(CLI::App& app, Command& chosen);
void addVerify(CLI::App& app, Command& chosen);
void addBench(CLI::App& app, Command& chosen);
void addReproduce(CLI::App& app, Command& chosen);
void addBake(CLI::App& app, Command& chosen);
void addCheck(CLI::App& app, Command& chosen);
void addQuery(CLI::App& app, Command& chosen);
void addLayers(CLI::App& app, Command& chosen);
// help, version, completion and manual. They tell what the other commands declare, so they are added last.
void addFrontDoor(CLI::App& app, Command& chosen);

}  // namespace sightline::tool
