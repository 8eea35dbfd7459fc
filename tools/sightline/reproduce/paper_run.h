#pragma once

// Runs the experiments of one paper.

#include "tools/sightline/commands.h"
#include "tools/sightline/reproduce/reproduction.h"

namespace sightline::tool {

// Runs one paper and writes what the options ask for. Error if an option is given that means nothing for it.
Result<ExitCode> runPaper(ReproduceOptions options);

}  // namespace sightline::tool
