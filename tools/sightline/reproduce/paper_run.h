#pragma once

// Runs the experiments of one paper or of all.

#include "tools/sightline/commands.h"
#include "tools/sightline/reproduce/reproduction.h"

namespace sightline::tool {

// The name that stands for all papers.
inline constexpr const char* kAllPapers = "all";

// Runs one paper and writes what the options ask for. Error if an option is given that means nothing for it.
Result<ExitCode> runPaper(ReproduceOptions options);

// Runs one paper after the other, each into a folder of its own in that of the options, and writes a page
// that leads to theirs. A paper whose folder is finished and was measured with the same options is not run
// again. Options that mean nothing for a paper are left out for it.
Result<ExitCode> runAllPapers(const ReproduceOptions& options);

}  // namespace sightline::tool
