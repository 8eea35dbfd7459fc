#pragma once

#include <fmt/format.h>

#include <utility>

#include "sightline/base/result.h"

namespace sightline {

// An Error with a formatted message.
template <typename... Args>
Error failure(fmt::format_string<Args...> text, Args&&... args) {
  return Error{fmt::format(text, std::forward<Args>(args)...)};
}

}  // namespace sightline
