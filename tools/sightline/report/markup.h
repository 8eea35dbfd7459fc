#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace sightline::tool {

// Escapes untrusted text for elements and quoted attributes of HTML and SVG. Control characters are dropped;
// bytes that are not UTF-8 become U+FFFD.
std::string escapeMarkup(std::string_view text);

// Makes a relative link of a file's name: "./" is put before it and unusual characters are percent-encoded.
std::string relativeLink(std::string_view file);

// 1234567.0 -> "1,234,567" with the given number of decimals; "–" when not finite.
std::string groupedNumber(double value, int decimals);
// 1234567 -> "1,234,567". Precondition: number < 2^53.
inline std::string grouped(std::uint64_t number) {
  return groupedNumber(static_cast<double>(number), 0);
}

// Number of characters (code points) of UTF-8 text.
std::size_t characterCount(std::string_view text);

}  // namespace sightline::tool
