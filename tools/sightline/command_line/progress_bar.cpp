#include "tools/sightline/command_line/progress_bar.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "tools/sightline/command_line/note.h"

namespace sightline::tool {
namespace {

constexpr int kWidth = 30;

std::string remaining(double seconds) {
  if (seconds < 100.0) {
    return fmt::format("{:.0f} s", seconds);
  }
  return seconds < 6000.0 ? fmt::format("{:.0f} min", seconds / 60.0)
                          : fmt::format("{:.1f} h", seconds / 3600.0);
}

}  // namespace

ProgressBar::ProgressBar(std::string stage, double begun)
    : stage_(std::move(stage)),
      begun_(begun),
      terminal_(isatty(STDERR_FILENO) == 1),
      start_(Clock::now()),
      last_(start_) {}

ProgressBar::~ProgressBar() {
  if (shown_) {
    printOnStderr(kClearLine);
  }
}

void ProgressBar::say(const std::string& line) {
  printOnStderr(shown_ ? kClearLine : "");
  printNote("{}", line);
  shown_ = false;
}

void ProgressBar::update(double done, const std::string& note) {
  if (!terminal_) {
    return;
  }
  const Clock::time_point now = Clock::now();
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  if (elapsed < 1.0 || std::chrono::duration<double>(now - last_).count() < 0.1) {
    return;
  }
  last_ = now;
  shown_ = true;
  done = std::clamp(done, 0.0, 1.0);
  const int filled = static_cast<int>(done * kWidth);
  std::string right =
      done > begun_ ? remaining(elapsed * (1.0 - done) / (done - begun_)) + " left" : std::string();
  right += note.empty() || right.empty() ? note : ", " + note;
  printOnStderr(fmt::format("{}{} [{:#<{}}{:.<{}}] {:3.0f} % {}", kClearLine, stage_, "", filled, "",
                            kWidth - filled, 100.0 * done, right));
}

}  // namespace sightline::tool
