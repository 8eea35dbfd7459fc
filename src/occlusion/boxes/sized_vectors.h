#pragma once

// Include this before Highway in a source that has vectors as members or in arrays, which those without a
// fixed size cannot be. Machines with these instruction sets take the best one that is left; no test is left
// out, all run on every set that is left.

// The build with sanitizers has named these and two more already: cmake/SightlineTarget.cmake says why
// nothing that it looks for is lost.
#if !defined(HWY_DISABLED_TARGETS)
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#endif
