#pragma once

// Baking all parts of a plan: in the threads of one process, or of several.

#include <cstdint>

#include "sightline/base/result.h"
#include "sightline/pvs/bake/bake.h"
#include "tools/sightline/bake/checkpoint.h"
#include "tools/sightline/bake/mpi_world.h"

namespace sightline::tool {

// What it took, of all processes.
struct BakeEffort {
  std::uint32_t processes = 1, threads = 1;  // threads: of each process
  std::uint32_t parts_before = 0;            // came from the checkpoint
  BakeStats stats{};                         // max_sample_bytes: of all threads together
  std::uint64_t peak_bytes = 0;              // of the process that had most
  std::uint64_t all_peak_bytes = 0;          // of all processes together
};

// All processes call it, with how each one fares: the first learns an error of any, the others only that
// there is one. number: has to be the same in all.
Status agree(MpiWorld& world, const Status& own, std::uint64_t number);

// The first process: hands parts out, keeps what is finished, and bakes as well. known: parts that were baked
// before. Where the process is told to end (SIGINT, SIGTERM), it ends here, the checkpoint whole.
Result<BakedParts> bakeAsFirst(const Bake& bake, MpiWorld& world, std::uint32_t threads,
                               Checkpoint& checkpoint, BakedParts known, BakeEffort& effort);

// The others: bake what the first process gives them, until there is no more.
void bakeAsOther(const Bake& bake, MpiWorld& world, std::uint32_t threads);

std::uint64_t peakBytes();  // of this process so far

}  // namespace sightline::tool
