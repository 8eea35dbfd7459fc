#pragma once

#include <span>
#include <string>
#include <string_view>

#include "sightline/base/result.h"

namespace sightline {

// Reads a whole file. An error names the file and the reason.
Result<std::string> readFile(const std::string& file);

// Writes a file under a temporary name beside the target and renames it, so that half a file never has the
// final name.
Result<void> writeFile(const std::string& file, std::string_view bytes);
// The same of bytes that lie in several places, one after the other.
Result<void> writeFile(const std::string& file, std::span<const std::string_view> pieces);

}  // namespace sightline
