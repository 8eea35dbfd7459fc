#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace sightline::base {

struct Utf8Character {
  char32_t code = 0;
  std::size_t length = 0;  // bytes; 0: no well-formed UTF-8
};

// The character that text (not empty) begins with. Overlong sequences, surrogates and codes beyond U+10FFFF
// are not well-formed (Unicode 15, table 3-7).
Utf8Character firstCharacter(std::string_view text);

// The code points of a text. Each byte that does not belong to well-formed UTF-8 becomes U+FFFD.
std::u32string decodeUtf8(std::string_view text);

// Appends a code point (at most U+10FFFF).
void appendUtf8(std::string& text, char32_t code);

}  // namespace sightline::base
