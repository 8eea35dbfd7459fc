#pragma once

// A source that has vectors as members or in arrays includes this before Highway.

// Vectors of these instruction sets have no fixed size, so they can be neither members nor in arrays.
// Machines that have such a set take the best one that is left. No test is left out: all run on every set
// that is left. The build with sanitizers has named these and two more already: cmake/SightlineTarget.cmake
// says why nothing that it looks for is lost.
#if !defined(HWY_DISABLED_TARGETS)
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#endif
