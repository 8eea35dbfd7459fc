#pragma once

// Witnesses as bytes, in the parts of a bake and in a file of their own.

#include <vector>

#include "sightline/pvs/format/witness.h"
#include "src/base/byte_stream.h"

namespace sightline::pvs {

void write(const std::vector<HidingWitness>& witnesses, base::ByteWriter& bytes);
// False if the bytes are not witnesses.
bool read(base::ByteReader& bytes, std::vector<HidingWitness>& witnesses);

}  // namespace sightline::pvs
