#pragma once

#include <hwy/targets.h>

#include <cstddef>
#include <cstdint>

namespace sightline::test {

// How many of them every machine has at least: one of x86 has several, one of ARM has NEON alone.
inline constexpr std::size_t kMinInstructionSets = HWY_ARCH_X86 ? 2 : 1;

// While it lives, vector code of this program uses this instruction set, which is one of
// hwy::SupportedAndGeneratedTargets(). Also where an assertion ends the test early, tests that follow in the
// same process use the best one again.
class ForcedInstructionSet {
 public:
  explicit ForcedInstructionSet(std::int64_t target) { hwy::SetSupportedTargetsForTest(target); }
  ~ForcedInstructionSet() { hwy::SetSupportedTargetsForTest(0); }
  ForcedInstructionSet(const ForcedInstructionSet&) = delete;
  ForcedInstructionSet& operator=(const ForcedInstructionSet&) = delete;
};

}  // namespace sightline::test
