#include "tools/sightline/command_line/manual.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include "tools/sightline/command_line/declarations.h"
#include "tools/sightline/command_line/options.h"
#include "tools/sightline/command_line/parse_text.h"

namespace sightline::tool {
namespace {

// Escapes text so that no line of it begins a request and hyphens can be copied to a terminal.
std::string escaped(const std::string& text) {
  std::string result;
  bool at_start = true;
  for (const char c : text) {
    if (at_start && (c == '.' || c == '\'')) {
      result += "\\&";
    }
    result += c == '\\'  ? "\\e"
              : c == '-' ? "\\-"
              : c == '`' ? "\\(ga"
              : c == '~' ? "\\(ti"
              : c == '^' ? "\\(ha"
                         : std::string(1, c);
    at_start = c == '\n';
  }
  return result;
}

std::string bold(const std::string& text) {
  return "\\fB" + escaped(text) + "\\fR";
}
std::string italic(const std::string& text) {
  return "\\fI" + escaped(text) + "\\fR";
}

// One paragraph for each line. Lines that begin with spaces are printed unchanged.
std::string paragraphs(const std::string& text) {
  std::string result;
  bool as_is = false;
  for (const std::string& line : splitAt(text, '\n')) {
    if (line.empty()) {
      continue;
    }
    const bool example = line[0] == ' ';
    if (example != as_is) {
      result += example ? ".PP\n.nf\n" : ".fi\n";
      as_is = example;
    }
    result += (example ? "" : ".PP\n") + escaped(line) + "\n";
  }
  return result + (as_is ? ".fi\n" : "");
}

std::string describe(const CLI::Option& option) {
  std::string text = option.get_description();
  if (const OptionWords words = wordsOf(option); !words.words.empty()) {
    text += fmt::format("; {} of: {}", words.list ? "some" : "one", fmt::join(words.words, ", "));
  }
  if (!option.get_default_str().empty() && !isFlag(option)) {
    text += fmt::format(" (default: {})", option.get_default_str());
  }
  return text;
}

std::string entry(const std::string& tag, const std::string& text) {
  return ".TP\n" + tag + "\n" + escaped(text) + "\n";
}

std::string optionEntry(const CLI::Option& option) {
  std::string tag;
  for (const std::string& name : spellings(option)) {
    tag += (tag.empty() ? "" : ", ") + bold(name);
  }
  return entry(tag + (isFlag(option) ? "" : " " + italic(typeOf(option))), describe(option));
}

std::string commandSection(const CLI::App& command) {
  std::string text = ".SS " + escaped(command.get_name()) + "\n.B sightline " + escaped(command.get_name());
  for (const CLI::Option* word : positionals(command)) {
    text += word->get_required() ? " " + escaped(word->get_name(true))
                                 : " [" + escaped(word->get_name(true)) + "]";
  }
  text += "\n[\\fIOPTIONS\\fR]\n.PP\n" + escaped(command.get_description()) + "\n";
  for (const CLI::Option* word : positionals(command)) {
    text += entry(italic(word->get_name(true)), describe(*word));
  }
  for (const CLI::Option* option : namedOptions(command)) {
    text += optionEntry(*option);
  }
  return text + paragraphs(command.get_footer());
}

}  // namespace

std::string manualPage(const CLI::App& app) {
  std::string page = fmt::format(".TH SIGHTLINE 1 \"\" \"{}\" \"User Commands\"\n", escaped(app.version()));
  page += ".SH NAME\nsightline \\- conservative visibility of 3D scenes\n";
  page += ".SH SYNOPSIS\n.B sightline\n\\fICOMMAND\\fR [\\fIOPTIONS\\fR]\n";
  page += ".SH DESCRIPTION\n" + escaped(app.get_description()) + "\n" + paragraphs(app.get_footer());
  page += ".SH OPTIONS\n";
  for (const CLI::Option* option : namedOptions(app)) {
    page += optionEntry(*option);
  }
  page += ".SH COMMANDS\n";
  for (const CLI::App* command : listedCommands(app)) {
    page += commandSection(*command);
  }
  return page;
}

}  // namespace sightline::tool
