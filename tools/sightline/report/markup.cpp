#include "tools/sightline/report/markup.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "src/base/utf8.h"

namespace sightline::tool {
namespace {

constexpr std::string_view kReplacement = "\xef\xbf\xbd";  // U+FFFD

// The length in bytes of the character that text begins with; 0: no UTF-8, or no character of XML.
std::size_t characterLength(std::string_view text) {
  const base::Utf8Character character = base::firstCharacter(text);
  return character.code == 0xfffe || character.code == 0xffff ? 0 : character.length;
}

std::string_view entity(char c) {
  switch (c) {
    case '&':
      return "&amp;";
    case '<':
      return "&lt;";
    case '>':
      return "&gt;";
    case '"':
      return "&quot;";
    case '\'':
      return "&#39;";
    default:
      return {};
  }
}

}  // namespace

std::string escapeMarkup(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const std::size_t length = characterLength(text);
    if (length == 0) {
      out += kReplacement;
    } else if (const std::string_view replaced = entity(text[0]); !replaced.empty()) {
      out += replaced;
    } else if (length > 1 || static_cast<std::uint8_t>(text[0]) >= 0x20 || text[0] == '\n' ||
               text[0] == '\t') {
      if (text[0] != '\x7f') {
        out += text.substr(0, length);
      }
    }
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return out;
}

std::string relativeLink(std::string_view file) {
  std::string out = "./";
  for (const char c : file) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '.' || c == '-' || c == '_' || c == '/';
    if (plain) {
      out += c;
    } else {
      out += fmt::format("%{:02X}", static_cast<unsigned>(static_cast<std::uint8_t>(c)));
    }
  }
  return out;
}

std::string groupedNumber(double value, int decimals) {
  if (!std::isfinite(value)) {
    return "–";
  }
  std::string digits = fmt::format("{:.{}f}", std::abs(value), decimals);
  const std::size_t point = std::min(digits.find('.'), digits.size());
  for (std::size_t i = point; i > 3; i -= 3) {
    digits.insert(i - 3, 1, ',');
  }
  const bool zero = digits.find_first_not_of("0.,") == std::string::npos;
  return (value < 0.0 && !zero ? "−" : "") + digits;
}

std::size_t characterCount(std::string_view text) {
  std::size_t count = 0;
  for (const char c : text) {
    count += (static_cast<std::uint8_t>(c) & 0xc0) != 0x80 ? 1 : 0;
  }
  return count;
}

}  // namespace sightline::tool
