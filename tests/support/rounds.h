#pragma once

// How much a test does that takes long with sanitizers.

extern "C" [[gnu::weak]] void __asan_init();  // AddressSanitizer's own

namespace sightline::test {

// Whether the library that is tested was built with sanitizers. The tests are compiled alike for both.
inline bool sanitized() {
  return &__asan_init != nullptr;
}

// Returns how many of `all` rounds a random test runs: a quarter of them where sanitizers make each take
// several times as long. The release build runs every round, for what is right in one may be wrong in
// another; the sanitizers look for mistakes of another kind, which most rounds have in common. Also for what
// all rounds together must have met: EXPECT_GT(hidden, rounds(500)), and for the size of an input.
template <typename Number>
Number rounds(Number all) {
  return sanitized() ? (all + 3) / 4 : all;
}

}  // namespace sightline::test
