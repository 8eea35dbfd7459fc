#pragma once

// Bakes all parts of a plan with the threads of one process or of several.

#include <cstdint>
#include <span>
#include <string_view>

#include "sightline/base/result.h"
#include "sightline/pvs/bake/bake.h"
#include "tools/sightline/bake/checkpoint.h"
#include "tools/sightline/bake/mpi_world.h"
#include "tools/sightline/command_line/progress_bar.h"

namespace sightline::tool {

// The cost of a bake, over all processes.
struct BakeEffort {
  std::uint32_t processes = 1, threads = 1;  // processes, and threads in each of them
  std::uint32_t parts_before = 0;            // parts that came from the checkpoint
  BakeStats stats{};                         // max_sample_bytes is the sum over all threads
  std::uint64_t peak_bytes = 0;              // the largest of all processes
  std::uint64_t all_peak_bytes = 0;          // the sum over all processes
};

// Called by all processes with their own status. The first process gets an error of any, the others learn
// only that there is one. It is also an error if number differs between processes.
Status agree(MpiWorld& world, const Status& own, std::uint64_t number);

// The first process's part of the work: hands out parts, keeps finished ones in the checkpoint alone, and
// bakes too. known: the ids of the parts that are there from before. Returns the number of parts. If the
// process is told to end (SIGINT, SIGTERM), it ends here with the checkpoint whole.
Result<std::uint64_t> bakeAsFirst(const Bake& bake, MpiWorld& world, std::uint32_t threads,
                                  Checkpoint& checkpoint, std::span<const std::uint64_t> known,
                                  BakeEffort& effort);

// Says how many of the known parts are done, and which share of the viewers' space they are (", 12 % of ...",
// or nothing), and ends the process. All that is done is in the checkpoint.
[[noreturn]] void endInterrupted(ProgressBar& bar, Checkpoint& checkpoint, std::uint64_t done,
                                 std::uint64_t known, std::string_view share);

// The other processes' part: they bake what the first process gives them until there is no more.
void bakeAsOther(const Bake& bake, MpiWorld& world, std::uint32_t threads);

std::uint64_t peakBytes();  // the peak memory of this process so far

}  // namespace sightline::tool
