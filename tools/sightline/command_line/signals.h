#pragma once

// Handles being told to end, by SIGINT (Ctrl-C) or SIGTERM.

#include <string>

namespace sightline::tool {

// From now on, if told to end, the process prints on stderr that `command` was interrupted and what is kept,
// removes the folders of removeWhenTold() that are empty, and exits with 128 + the signal's number. Signals
// that were ignored when the process started stay ignored.
void endWhenTold(const std::string& command);
// Sets the text about what is kept. Until this is called it names the files of noteWritten(), or says that
// nothing was written.
void keepWhenTold(const std::string& kept);
// Adds a file to those that the text names. For one thread at a time, until keepWhenTold() is called.
void noteWritten(const std::string& file);
void removeWhenTold(const std::string& folder);

// While a guard lives, being told to end is only noted. It protects work that must not stop in the middle.
class SignalGuard {
 public:
  SignalGuard();
  ~SignalGuard();
  SignalGuard(const SignalGuard&) = delete;
  SignalGuard& operator=(const SignalGuard&) = delete;
};

// The signal that was noted, or 0.
int toldToEnd();
// 128 + the number of the noted signal. Precondition: toldToEnd() != 0.
int interruptedExitCode();
// Ends the process now if it was told to, unless a SignalGuard lives.
void endIfTold();

}  // namespace sightline::tool
