#include "tools/sightline/command_line/declarations.h"

#include <CLI/CLI.hpp>

namespace sightline::tool {

std::vector<const CLI::App*> listedCommands(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* command) { return !command->get_group().empty(); });
}

std::vector<std::string> commandNames(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : listedCommands(app)) {
    names.push_back(command->get_name());
  }
  return names;
}

std::vector<const CLI::Option*> namedOptions(const CLI::App& command) {
  return command.get_options([](const CLI::Option* option) { return option->nonpositional(); });
}

std::vector<const CLI::Option*> positionals(const CLI::App& command) {
  return command.get_options([](const CLI::Option* option) { return !option->nonpositional(); });
}

std::vector<std::string> spellings(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) {
    names.push_back("-" + name);
  }
  for (const std::string& name : option.get_lnames()) {
    names.push_back("--" + name);
  }
  return names;
}

std::vector<std::string> allSpellings(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : namedOptions(command)) {
    for (const std::string& name : spellings(*option)) {
      names.push_back(name);
    }
  }
  return names;
}

bool isFlag(const CLI::Option& option) {
  return option.get_type_size() == 0;
}

std::string typeOf(const CLI::Option& option) {
  const std::string type = option.get_type_name();  // with its checks: "TEXT:{on,off}"
  return type.substr(0, type.find(':'));
}

std::string overview(const CLI::App& app) {
  return app.get_formatter()->make_help(&app, app.get_name(), CLI::AppFormatMode::Normal);
}

}  // namespace sightline::tool
