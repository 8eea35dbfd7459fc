#include "src/base/utf8.h"

#include <algorithm>
#include <array>

namespace sightline::base {
namespace {

// The number of bytes that a first byte announces; 0: no character begins with it.
std::size_t lengthOf(unsigned char first) {
  return first < 0x80 ? 1 : first < 0xc2 ? 0 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : first < 0xf5 ? 4 : 0;
}

}  // namespace

Utf8Character firstCharacter(std::string_view text) {
  const auto first = static_cast<unsigned char>(text[0]);
  const std::size_t length = lengthOf(first);
  if (length == 0 || length > text.size()) {
    return {};
  }
  if (length == 1) {
    return {first, 1};
  }
  char32_t code = first & (0xffu >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if ((byte & 0xc0u) != 0x80u) {
      return {};
    }
    code = code << 6 | (byte & 0x3fu);
  }
  constexpr std::array<char32_t, 5> kMin{0, 0, 0x80, 0x800, 0x10000};  // by length: smaller ones are overlong
  const bool surrogate = code >= 0xd800 && code < 0xe000;
  return code >= kMin[length] && code <= 0x10ffff && !surrogate ? Utf8Character{code, length}
                                                                : Utf8Character{};
}

std::u32string decodeUtf8(std::string_view text) {
  std::u32string decoded;
  while (!text.empty()) {
    const Utf8Character character = firstCharacter(text);
    decoded += character.length == 0 ? U'\ufffd' : character.code;
    text.remove_prefix(std::max<std::size_t>(character.length, 1));
  }
  return decoded;
}

void appendUtf8(std::string& text, char32_t code) {
  const auto put = [&](char32_t byte) { text += static_cast<char>(static_cast<unsigned char>(byte)); };
  if (code < 0x80) {
    put(code);
  } else if (code < 0x800) {
    put(0xc0 | code >> 6);
    put(0x80 | (code & 0x3f));
  } else if (code < 0x10000) {
    put(0xe0 | code >> 12);
    put(0x80 | (code >> 6 & 0x3f));
    put(0x80 | (code & 0x3f));
  } else {
    put(0xf0 | code >> 18);
    put(0x80 | (code >> 12 & 0x3f));
    put(0x80 | (code >> 6 & 0x3f));
    put(0x80 | (code & 0x3f));
  }
}

}  // namespace sightline::base
