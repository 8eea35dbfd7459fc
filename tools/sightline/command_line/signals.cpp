// The signal handler uses only what is allowed in one: memory that was filled before, write, rmdir and _exit.

#include "tools/sightline/command_line/signals.h"

#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <vector>

#include "tools/sightline/command_line/note.h"

namespace sightline::tool {
namespace {

// What the handler reads. It is changed only while a SignalGuard defers signals.
struct Ending {
  std::string command, text;
  std::string written;               // files that were written whole
  bool stated = false;               // whether keepWhenTold() has set the text
  std::vector<std::string> folders;  // outer folders before inner ones
};

Ending& ending() {
  static Ending ending;
  return ending;
}

volatile std::sig_atomic_t told = 0;
std::atomic<int> guards = 0;
static_assert(std::atomic<int>::is_always_lock_free);

[[noreturn]] void endNow() {
  const std::string& text = ending().text;
  if (::write(STDERR_FILENO, text.data(), text.size()) < 0) {
    // Nothing can be done if stderr is closed.
  }
  for (auto folder = ending().folders.rbegin(); folder != ending().folders.rend(); ++folder) {
    ::rmdir(folder->c_str());
  }
  ::_exit(interruptedExitCode());
}

void setText(const std::string& kept) {
  ending().text = std::string(isatty(STDERR_FILENO) == 1 ? kClearLine : "") +
                  "sightline: " + ending().command + " was interrupted; " + kept + "\n";
}

extern "C" void noteSignal(int signal) {
  if (told != 0) {
    ::_exit(128 + signal);  // told twice: finishing the protected work takes too long
  }
  told = signal;
  if (guards == 0) {
    endNow();
  }
}

}  // namespace

void endWhenTold(const std::string& command) {
  ending().command = command;
  setText("nothing was written");
  struct sigaction action {};
  action.sa_handler = noteSignal;
  for (const int signal : std::array{SIGINT, SIGTERM}) {
    struct sigaction old {};
    sigaction(signal, nullptr, &old);
    if (old.sa_handler != SIG_IGN) {
      sigaction(signal, &action, nullptr);
    }
  }
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is an error of the write
}

void keepWhenTold(const std::string& kept) {
  {
    const SignalGuard guard;
    ending().stated = true;
    setText(kept);
  }
  endIfTold();
}

void noteWritten(const std::string& file) {
  const SignalGuard guard;
  if (!ending().stated) {
    ending().written += (ending().written.empty() ? "" : ", ") + file;
    setText("written so far: " + ending().written);
  }
}

void removeWhenTold(const std::string& folder) {
  {
    const SignalGuard guard;
    ending().folders.push_back(folder);
  }
  endIfTold();
}

SignalGuard::SignalGuard() {
  ++guards;
}

SignalGuard::~SignalGuard() {
  --guards;
}

int toldToEnd() {
  return told;
}

int interruptedExitCode() {
  return 128 + told;
}

void endIfTold() {
  if (told != 0 && guards == 0) {
    endNow();
  }
}

}  // namespace sightline::tool
