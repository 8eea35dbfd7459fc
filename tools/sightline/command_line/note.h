#pragma once

// Notes and errors on stderr. If stderr is closed or full, that changes nothing else: what fails here is
// ignored. As of any program, a pipe that nobody reads ends the process.

#include <fmt/format.h>

#include <string_view>
#include <utility>

namespace sightline::tool {

inline constexpr const char* kClearLine = "\r\033[K";  // erases a progress bar

void printOnStderr(std::string_view text);

// Prints a line that begins with "sightline: ".
template <typename... Args>
void printNote(fmt::format_string<Args...> format, Args&&... args) {
  printOnStderr("sightline: " + fmt::format(format, std::forward<Args>(args)...) + "\n");
}

}  // namespace sightline::tool
