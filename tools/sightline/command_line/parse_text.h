#pragma once

// Words and numbers of the command line.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace sightline::tool {

// "a,,b" -> a, nothing, b: one part more than separators.
std::vector<std::string> splitAt(const std::string& text, char separator);

// The whole text is a number, or there is none: no spaces, no sign but a decimal's minus, no overflow.
std::optional<std::uint32_t> parseWhole(const std::string& text);
std::optional<double> parseDecimal(const std::string& text);  // finite

}  // namespace sightline::tool
