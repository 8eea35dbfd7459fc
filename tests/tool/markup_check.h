#pragma once

// A small check of HTML and SVG text: are tags balanced, and is nothing of what was given as text a tag?

#include <string>
#include <string_view>
#include <vector>

namespace sightline::tool {

// Empty when every tag that opens closes in order; otherwise what is wrong.
inline std::string firstMarkupError(std::string_view text) {
  constexpr std::string_view kVoid[] = {"meta", "img", "br", "!DOCTYPE"};
  std::vector<std::string> open;
  for (std::size_t at = text.find('<'); at != std::string_view::npos; at = text.find('<', at)) {
    const std::size_t end = text.find('>', at);
    if (end == std::string_view::npos) {
      return "a tag without an end";
    }
    const std::string_view tag = text.substr(at + 1, end - at - 1);
    at = end;
    if (tag.find('<') != std::string_view::npos) {
      return "a tag within a tag: " + std::string(tag);
    }
    std::size_t quotes = 0;
    for (const char c : tag) {
      quotes += c == '"' ? 1 : 0;
    }
    if (quotes % 2 != 0) {
      return "an open quote: " + std::string(tag);
    }
    const bool closes = tag.starts_with('/');
    const std::string name(tag.substr(closes ? 1 : 0, tag.find_first_of(" \n/", 1) - (closes ? 1 : 0)));
    bool is_void = tag.ends_with('/');
    for (const std::string_view v : kVoid) {
      is_void = is_void || name == v;
    }
    if (closes) {
      if (open.empty() || open.back() != name) {
        return "</" + name + "> closes " + (open.empty() ? "nothing" : "<" + open.back() + ">");
      }
      open.pop_back();
    } else if (!is_void) {
      open.push_back(name);
    }
  }
  return open.empty() ? "" : "<" + open.back() + "> is not closed";
}

inline std::size_t countOf(std::string_view text, std::string_view part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string_view::npos;
       at = text.find(part, at + part.size())) {
    ++count;
  }
  return count;
}

}  // namespace sightline::tool
