#include "tools/sightline/command_line/completion.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <string_view>

#include "tools/sightline/command_line/declarations.h"
#include "tools/sightline/command_line/options.h"

namespace sightline::tool {
namespace {

// The text in single quotes, for any of the shells.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    result += c == '\'' ? "'\\''" : std::string(1, c);
  }
  return result + "'";
}

// The first word that a command takes by its place; null where it takes none.
const CLI::Option* firstPositional(const CLI::App& command) {
  const auto words = positionals(command);
  return words.empty() ? nullptr : words.front();
}

// The bash statement that describes an option's value: "words=...", "kind=file", "kind=folder", or "return"
// if nothing is known about it.
std::string bashValue(const CLI::Option& option) {
  if (const OptionWords words = wordsOf(option); !words.words.empty()) {
    return fmt::format("words={}{}", quoted(fmt::format("{}", fmt::join(words.words, " "))),
                       words.list ? " list=1" : "");
  }
  const std::string type = typeOf(option);
  return type == kFileType ? "kind=file" : type == kFolderType ? "kind=folder" : "return";
}

std::string bashCommand(const CLI::App& command) {
  std::string text = fmt::format("    {})\n      options={}\n", command.get_name(),
                                 quoted(fmt::format("{}", fmt::join(allSpellings(command), " "))));
  text += "      case $previous in\n";
  for (const CLI::Option* option : namedOptions(command)) {
    if (!isFlag(*option)) {
      text += fmt::format("        {}) {} ;;\n", fmt::join(spellings(*option), " | "), bashValue(*option));
    }
  }
  if (const CLI::Option* word = firstPositional(command)) {
    text += fmt::format("        *) {} ;;\n", bashValue(*word));
  }
  return text + "      esac ;;\n";
}

constexpr const char* kBashHead =
    R"(# Completion of sightline's words in bash, printed by: sightline completion bash
_sightline() {
  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]}
  local options= words= list= kind=
  # bash takes --option=value for three words.
  if [[ $current == = ]]; then
    current=
  elif [[ $previous == = ]]; then
    previous=${COMP_WORDS[COMP_CWORD - 2]}
  fi
  COMPREPLY=()
  if ((COMP_CWORD == 1)); then
    mapfile -t COMPREPLY < <(compgen -W "$SIGHTLINE_COMMANDS" -- "$current")
    return
  fi
  case ${COMP_WORDS[1]} in
)";

constexpr const char* kBashTail = R"(  esac
  if [[ $current == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$current")
  elif [[ -n $list && $current == *,* ]]; then
    mapfile -t COMPREPLY < <(compgen -P "${current%,*}," -W "$words" -- "${current##*,}")
  elif [[ -n $words ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
  elif [[ $kind == folder ]]; then
    compopt -o filenames 2> /dev/null
    mapfile -t COMPREPLY < <(compgen -d -- "$current")
  elif [[ $kind == file ]]; then
    compopt -o filenames 2> /dev/null
    mapfile -t COMPREPLY < <(compgen -f -- "$current")
  fi
}
complete -F _sightline sightline
)";

std::string bashScript(const CLI::App& app) {
  std::string head = kBashHead;
  const std::string names = fmt::format("{}", fmt::join(commandNames(app), " "));
  constexpr std::string_view kPlace = "$SIGHTLINE_COMMANDS";
  head.replace(head.find(kPlace), kPlace.size(), names + " --help --version");
  for (const CLI::App* command : listedCommands(app)) {
    head += bashCommand(*command);
  }
  return head + kBashTail;
}

}  // namespace

std::vector<std::string> shellNames() {
  return {"bash"};
}

std::string completionScript(const CLI::App& app, const std::string& shell) {
  return shell == "bash" ? bashScript(app) : std::string();
}

}  // namespace sightline::tool
