#pragma once

// Numbers that no function may be harmed by.

#include <limits>

namespace sightline::test {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

}  // namespace sightline::test
