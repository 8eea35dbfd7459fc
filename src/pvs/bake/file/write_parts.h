#pragma once

// Writes a .sight file from the parts of a bake without having its sets in memory.

#include <cstdint>
#include <string>

#include "sightline/base/result.h"
#include "sightline/pvs/format/baked_visibility.h"
#include "src/pvs/bake/file/assemble_parts.h"

namespace sightline::pvs {

// baked: everything but the octree's cells, the sets, and the doors; the octree and the doors are filled in.
// broken: the id of a part that cannot be read, in which case no file is written, or 0.
Status writeParts(const std::string& file, const BakeScene& scene, const ReadCell& read,
                  BakedVisibility& baked, std::uint64_t& broken);

}  // namespace sightline::pvs
