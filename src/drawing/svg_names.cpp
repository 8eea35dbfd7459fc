#include "src/drawing/svg_names.h"

#include "src/base/utf8.h"

namespace sightline::drawing {
namespace {

bool isLetter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

bool isNameCharacter(char c) {
  return isLetter(c) || (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '_';
}

bool isXmlCharacter(char32_t code) {
  return code == U'\t' || code == U'\n' || code == U'\r' || (code >= 0x20 && code < 0xfffe) ||
         code >= 0x10000;
}

}  // namespace

std::string escapeXml(std::string_view text) {
  std::string escaped;
  for (const char32_t code : base::decodeUtf8(text)) {
    switch (code) {
      case U'&':
        escaped += "&amp;";
        break;
      case U'<':
        escaped += "&lt;";
        break;
      case U'>':
        escaped += "&gt;";
        break;
      case U'"':
        escaped += "&quot;";
        break;
      case U'\t':
      case U'\n':
      case U'\r':
        // Unescaped, these characters become spaces in attributes.
        escaped += "&#" + std::to_string(static_cast<int>(code)) + ";";
        break;
      default:
        base::appendUtf8(escaped, isXmlCharacter(code) ? code : U'\ufffd');
    }
  }
  return escaped;
}

std::string XmlIds::make(std::string_view name) {
  std::string base;
  for (const char32_t code : base::decodeUtf8(name)) {
    const char c = code < 0x80 ? static_cast<char>(code) : '_';
    base += isNameCharacter(c) ? c : '_';
  }
  if (base.empty() || (!isLetter(base[0]) && base[0] != '_')) {
    base.insert(base.begin(), '_');
  }
  std::string id = base;
  std::uint32_t& number = last_.try_emplace(base, 1).first->second;
  while (!taken_.insert(id).second) {
    id = base + "-" + std::to_string(++number);
  }
  return id;
}

}  // namespace sightline::drawing
