#pragma once

#include <string>

#include "sightline/base/result.h"
#include "sightline/pvs/format/baked_visibility.h"

namespace sightline {

// Writes a .sight file under a temporary name beside the target and renames it, so that the file is complete
// or absent. The same data gives the same bytes. Returns an error if the data is invalid or cannot be
// written.
Result<void> writeSight(const std::string& file, const BakedVisibility& baked);

}  // namespace sightline
