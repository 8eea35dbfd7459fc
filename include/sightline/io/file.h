#pragma once

#include <string>
#include <string_view>

#include "sightline/base/result.h"

namespace sightline {

// The whole file; an error names it and the reason.
Result<std::string> readFile(const std::string& file);

// Writes under a temporary name beside the target and renames: never half a file under the final name.
Status writeFile(const std::string& file, std::string_view bytes);

}  // namespace sightline
