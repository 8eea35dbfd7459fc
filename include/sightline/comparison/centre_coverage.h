#pragma once

// Approximate coverage: pixels sampled at their centres, to compare the conservative rasteriser with.

#include "sightline/occlusion/rasteriser.h"

namespace sightline {

// Returns the rule by which a pixel is covered where its centre is, with the depth there. It is NOT
// conservative: what can be seen through a gap between centres is hidden. Lives as long as the program; any
// number of threads may use it. Source: Poon, Wang 1999.
const CoverageRule* centreCoverage();

}  // namespace sightline
