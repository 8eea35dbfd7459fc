// sightline help, version, completion and manual.

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <memory>

#include "tools/sightline/command_line/completion.h"
#include "tools/sightline/command_line/declarations.h"
#include "tools/sightline/command_line/manual.h"
#include "tools/sightline/command_line/options.h"
#include "tools/sightline/commands.h"

namespace sightline::tool {
namespace {

// Commands in this group are not listed.
constexpr const char* kHidden = "";

Result<ExitCode> print(const std::string& text) {
  fmt::print("{}", text);
  return kOk;
}

void addHelp(CLI::App& app, Command& chosen) {
  const auto about = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("help", "the list of commands, or the options of one");
  std::vector<std::string> names = commandNames(app);
  command->add_option("COMMAND", *about, "the command to tell about")->check(isOneOf(names));
  command->footer(
      "Examples:\n"
      "  sightline help\n"
      "  sightline help walk");
  command->callback([about, &app, &chosen] {
    chosen = [about, &app] {
      return print(about->empty() ? overview(app) : app.get_subcommand(*about)->help(app.get_name()));
    };
  });
}

void addVersion(CLI::App& app, Command& chosen) {
  app.add_subcommand("version", "the version of this program")->callback([&app, &chosen] {
    chosen = [&app] { return print(app.version() + "\n"); };
  });
}

void addCompletion(CLI::App& app, Command& chosen) {
  const auto shell = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand(
      "completion", "the script by which a shell completes commands, options, their words and files");
  command->add_option("SHELL", *shell, "the shell that reads the script")
      ->required()
      ->check(isOneOf(shellNames()));
  command->footer(
      "Examples:\n"
      "  source <(sightline completion bash)");
  command->callback(
      [shell, &app, &chosen] { chosen = [shell, &app] { return print(completionScript(app, *shell)); }; });
}

void addManual(CLI::App& app, Command& chosen) {
  CLI::App* command = app.add_subcommand("manual", "prints the manual page, sightline.1");
  command->group(kHidden);
  command->callback([&app, &chosen] { chosen = [&app] { return print(manualPage(app)); }; });
}

}  // namespace

void addFrontDoor(CLI::App& app, Command& chosen) {
  addVersion(app, chosen);
  addCompletion(app, chosen);
  addManual(app, chosen);
  addHelp(app, chosen);
}

}  // namespace sightline::tool
