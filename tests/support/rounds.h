#pragma once

// How much a test does that takes long with sanitizers.

namespace sightline::test {

#if defined(SIGHTLINE_SANITIZED)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

// Returns how many of `all` rounds a random test runs: a quarter of them where sanitizers make each take
// several times as long. The release build runs every round, for what is right in one may be wrong in
// another; the sanitizers look for mistakes of another kind, which most rounds have in common. Also for what
// all rounds together must have met: EXPECT_GT(hidden, rounds(500)), and for the size of an input.
template <typename Number>
constexpr Number rounds(Number all) {
  return kSanitized ? (all + 3) / 4 : all;
}

}  // namespace sightline::test
