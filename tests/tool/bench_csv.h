#pragma once

// Reads the CSV that `sightline bench` writes.

#include <map>
#include <string>
#include <vector>

namespace sightline::tool_test {

// The fields of each line; quotes are taken off (RFC 4180).
inline std::vector<std::vector<std::string>> csvLines(const std::string& text) {
  std::vector<std::vector<std::string>> lines{{""}};
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::string& field = lines.back().back();
    if (text[i] == '"' && quoted && i + 1 < text.size() && text[i + 1] == '"') {
      field += text[++i];
    } else if (text[i] == '"') {
      quoted = !quoted;
    } else if (text[i] == ',' && !quoted) {
      lines.back().emplace_back();
    } else if (text[i] == '\n' && !quoted) {
      lines.push_back({""});
    } else {
      field += text[i];
    }
  }
  if (lines.back().size() == 1 && lines.back().front().empty()) {
    lines.pop_back();
  }
  return lines;
}

using CsvRow = std::map<std::string, std::string>;

// A map from a column's name to its field for each row below the head.
inline std::vector<CsvRow> csvRows(const std::string& text) {
  const std::vector<std::vector<std::string>> lines = csvLines(text);
  std::vector<CsvRow> rows;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    CsvRow& row = rows.emplace_back();
    for (std::size_t c = 0; c < lines[i].size() && c < lines.front().size(); ++c) {
      row[lines.front()[c]] = lines[i][c];
    }
  }
  return rows;
}

}  // namespace sightline::tool_test
