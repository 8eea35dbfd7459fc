#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace sightline::tool {

// A table for the terminal. Columns are as wide as their longest cell.
struct TextTable {
  std::vector<std::string> head{};
  std::vector<std::vector<std::string>> rows{};  // each with one cell for each column
  std::size_t left = 1;                          // the number of columns of words; the others hold numbers
};

// The table as text, one line for each row.
std::string toText(const TextTable& table);

// The text as one value of comma-separated values: in quotes if it has a comma, a quote or a line break
// (RFC 4180).
std::string csvText(const std::string& text);

}  // namespace sightline::tool
