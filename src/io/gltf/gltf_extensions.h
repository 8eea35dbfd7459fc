#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sightline::io {

// Whether a file may require the extension: it changes nothing of what we read (but shading, light and
// metadata), or we read it.
bool mayBeRequired(std::string_view extension);

// What is to be told of the extensions that a file uses: the names of those that may change what is shown,
// or where, in a way that is not read. Empty if there are none.
std::string noteOnExtensions(const std::vector<std::string>& used);

}  // namespace sightline::io
