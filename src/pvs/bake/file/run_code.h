#pragma once

// Counts and runs as bytes: numbers below 128 take one byte. Reading is for bytes of any origin.

#include <cstdint>

#include "src/base/byte_stream.h"
#include "src/pvs/bake/runs.h"

namespace sightline::pvs {

// Seven bits a byte, lowest first; the eighth says that more follow.
void addCount(std::uint64_t value, base::ByteWriter& bytes);
// The number; more than any count can be if there is none.
std::uint64_t readCount(base::ByteReader& bytes);

// The number of runs; then each run as its distance from the end of the one before, and its length.
void addRuns(const Runs& runs, base::ByteWriter& bytes);
// False if the bytes are not runs of so many objects.
bool readRuns(base::ByteReader& bytes, std::uint32_t object_count, Runs& runs);

}  // namespace sightline::pvs
