#pragma once

#include <hwy/targets.h>

#include <cstdint>

namespace sightline::test {

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
