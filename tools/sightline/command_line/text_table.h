#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace sightline::tool {

// A table for the terminal; columns are as wide as they need.
struct TextTable {
  std::vector<std::string> head{};
  std::vector<std::vector<std::string>> rows{};  // a cell a column
  std::size_t left = 1;                          // so many columns are words, the others are numbers
};

// One line a row, each ended.
std::string toText(const TextTable& table);

}  // namespace sightline::tool
