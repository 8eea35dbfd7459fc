#pragma once

// Parses words and numbers of the command line.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sightline/math/vec3.h"

namespace sightline::tool {

// Splits at each separator, so that there is one part more than separators: "a,,b" -> "a", "", "b".
std::vector<std::string> splitAt(const std::string& text, char separator);

// The number that the whole text is; none if it has spaces, a sign (other than a decimal's minus) or
// overflows.
std::optional<std::uint32_t> parseWhole(const std::string& text);
std::optional<double> parseDecimal(const std::string& text);  // finite numbers only
// The finite numbers of a text with exactly so many of them, separated by commas; empty if it is none.
std::vector<double> parseDecimals(const std::string& text, std::size_t count);
// X,Y,Z
std::optional<Vec3d> parsePoint(const std::string& text);

}  // namespace sightline::tool
