#pragma once

#include <fmt/format.h>

#include <exception>
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

// What nlohmann-json found to be wrong, and where. Its exceptions begin with their own names, as in
// "[json.exception.parse_error.101] parse error at line 1, column 1: ...".
inline std::string jsonFault(const std::exception& exception) {
  const std::string text = exception.what();
  const std::size_t name_end = text.find("] ");
  return text.starts_with("[json.exception.") && name_end != std::string::npos ? text.substr(name_end + 2)
                                                                               : text;
}

}  // namespace sightline::io
