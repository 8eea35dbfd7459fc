#include "tools/sightline/command_line/text_table.h"

#include <fmt/format.h>

#include <algorithm>

namespace sightline::tool {

std::string toText(const TextTable& table) {
  std::vector<std::size_t> widths(table.head.size(), 0);
  const auto measure = [&](const std::vector<std::string>& row) {
    for (std::size_t c = 0; c < widths.size(); ++c) {
      widths[c] = std::max(widths[c], row[c].size());
    }
  };
  std::string text;
  const auto add = [&](const std::vector<std::string>& row) {
    std::string line;
    for (std::size_t c = 0; c < widths.size(); ++c) {
      line += c == 0 ? "" : "  ";
      line += c < table.left ? fmt::format("{:<{}}", row[c], widths[c])
                             : fmt::format("{:>{}}", row[c], widths[c]);
    }
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  };
  measure(table.head);
  std::for_each(table.rows.begin(), table.rows.end(), measure);
  add(table.head);
  std::for_each(table.rows.begin(), table.rows.end(), add);
  return text;
}

std::string csvText(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) {
    return text;
  }
  std::string quoted = "\"";
  for (const char c : text) {
    quoted += c == '"' ? "\"\"" : std::string(1, c);
  }
  return quoted + "\"";
}

}  // namespace sightline::tool
