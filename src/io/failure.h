#pragma once

#include <fmt/format.h>

#include <string>
#include <utility>

#include "sightline/base/result.h"

namespace sightline::io {

// Text from a file may hold line breaks and other control characters; an error has one line.
inline std::string oneLine(std::string text) {
  for (char& c : text) {
    const auto code = static_cast<unsigned char>(c);
    c = code < 0x20 || code == 0x7f ? ' ' : c;
  }
  return text;
}

// An Error with a formatted message.
template <typename... Args>
Error failure(fmt::format_string<Args...> text, Args&&... args) {
  return Error{oneLine(fmt::format(text, std::forward<Args>(args)...))};
}

}  // namespace sightline::io
