#pragma once

#include <string>

#include "sightline/base/result.h"
#include "sightline/pvs/format/baked_visibility.h"

namespace sightline {

// Writes a .sight file under a temporary name beside it and renames it: the file is there whole or not at
// all. The same data gives the same bytes.
Status writeSight(const std::string& file, const BakedVisibility& baked);

}  // namespace sightline
