// The leading digits of whole numbers keep their sign.

#include "oracle/exact_number.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sightline {
namespace {

// A number of `limbs` limbs of 64 bits: the lowest is given, those between are 0, the highest is 5.
Whole sparse(unsigned limbs, std::uint64_t lowest) {
  return (Whole(5) << (64 * (limbs - 1))) + lowest;
}

TEST(ExactNumber, TheLeadingPartIsOfTheNumbersSign) {
  for (unsigned limbs = 2; limbs <= 5; ++limbs) {
    for (const std::uint64_t lowest : {0u, 1u, 2u}) {
      // The lowest limb is far below what is left.
      const unsigned dropped = 64 * (limbs - 1) - 40;
      const double expected = std::ldexp(5.0, 40);
      EXPECT_EQ(leadingPart(sparse(limbs, lowest), dropped), expected) << limbs << " limbs, " << lowest;
      EXPECT_EQ(leadingPart(-sparse(limbs, lowest), dropped), -expected) << limbs << " limbs, " << lowest;
    }
  }
  EXPECT_EQ(leadingPart(Whole(0), 0), 0.0);
  EXPECT_EQ(leadingPart(Whole(-7), 1), -3.0);
}

}  // namespace
}  // namespace sightline
