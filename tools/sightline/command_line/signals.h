#pragma once

// What happens when the process is told to end, by SIGINT (Ctrl-C) or SIGTERM.

#include <string>

namespace sightline::tool {

// From now on the process that is told to end says on stderr that `command` was interrupted and what is kept,
// removes the folders of removeWhenTold that are empty, and ends with 128 + the signal's number. Signals that
// the process was started to ignore stay ignored.
void endWhenTold(const std::string& command);
// What is kept; "nothing was written" until this is called.
void keepWhenTold(const std::string& kept);
void removeWhenTold(const std::string& folder);

// While one lives, being told to end is only noted: for work that must not stop in the middle.
class SignalGuard {
 public:
  SignalGuard();
  ~SignalGuard();
  SignalGuard(const SignalGuard&) = delete;
  SignalGuard& operator=(const SignalGuard&) = delete;
};

// The signal that was noted; 0: none.
int toldToEnd();
// 128 + the noted signal's number. Precondition: toldToEnd().
int interruptedExitCode();
// Ends the process now if it was told to, unless a SignalGuard lives.
void endIfTold();

}  // namespace sightline::tool
