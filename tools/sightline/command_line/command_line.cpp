#include "tools/sightline/command_line/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <string_view>

namespace sightline::tool {
namespace {

std::string shellWord(const std::string& word) {
  const auto plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) ||
           std::string_view("-_./:,=+@%").find(c) != std::string_view::npos;
  };
  if (!word.empty() && std::all_of(word.begin(), word.end(), plain)) {
    return word;
  }
  std::string quoted = "'";
  for (const char c : word) {
    quoted += c == '\'' ? "'\\''" : std::string(1, c);
  }
  return quoted + "'";
}

}  // namespace

std::string commandLine(const CLI::App& command) {
  std::string words, options;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& value : option->results()) {
      if (option->nonpositional()) {
        options += " " + option->get_name() + " " + shellWord(value);
      } else {
        words += " " + shellWord(value);
      }
    }
  }
  return "sightline " + command.get_name() + words + options;
}

}  // namespace sightline::tool
