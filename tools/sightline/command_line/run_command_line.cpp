#include "tools/sightline/command_line/run_command_line.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <string_view>

#include "tools/sightline/bake/mpi_world.h"
#include "tools/sightline/command_line/declarations.h"
#include "tools/sightline/command_line/note.h"
#include "tools/sightline/command_line/options.h"
#include "tools/sightline/command_line/signals.h"
#include "tools/sightline/command_line/standard_streams.h"
#include "tools/sightline/command_line/suggest.h"

namespace sightline::tool {
namespace {

int fail(std::string message) {
  std::replace(message.begin(), message.end(), '\n', ' ');
  while (!message.empty() && message.back() == ' ') {
    message.pop_back();
  }
  printNote("{}", message);
  return kBadUsage;
}

// Whether this process prints and fails for itself. Of the processes of one bake only the first does: mpirun
// ends the others as soon as one has failed.
bool speaks(int argc, char** argv) {
  return !(argc > 1 && std::string_view(argv[1]) == "bake" && isOtherMpiProcess());
}

bool isCommand(const CLI::App& app, const std::string& word) {
  return !app.get_subcommands([&](const CLI::App* command) { return command->get_name() == word; }).empty();
}

Error noSuchCommand(const CLI::App& app, const std::string& word) {
  const std::vector<std::string> names = commandNames(app);
  return Error{fmt::format("there is no command '{}'; choose from: {}{}", word, fmt::join(names, ", "),
                           didYouMean(word, names))};
}

bool takesOneScene(const CLI::App& command) {
  const CLI::Option* const scene = command.get_option_no_throw("SCENE");
  return scene != nullptr && scene->get_items_expected_max() == 1;
}

// Why words were refused. An option that does not exist comes first: what else is wrong often follows from
// it.
Error whyRefused(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<CLI::App*> chosen = app.get_subcommands();
  const CLI::App& command = chosen.empty() ? app : *chosen.front();
  const std::string see = chosen.empty() ? "sightline --help" : "sightline " + command.get_name() + " --help";
  for (const std::string& word : app.remaining(true)) {
    if (word.size() > 1 && word[0] == '-') {
      const std::string name = word.substr(0, word.find('='));
      return Error{fmt::format("there is no option {}{} (see {})", name,
                               didYouMean(name, allSpellings(command)), see)};
    }
  }
  if (const std::vector<std::string> words = app.remaining(true); !words.empty() && takesOneScene(command)) {
    return Error{fmt::format("{} takes one SCENE; '{}' is one word too many (see {})", command.get_name(),
                             words.front(), see)};
  }
  return Error{fmt::format("{} (see {})", error.what(), see)};
}

// The first option that ends in '=', empty if none does. CLI11 would take the next word for its value.
std::string optionWithoutValue(int argc, char** argv) {
  for (int i = 1; i < argc && std::string_view(argv[i]) != "--"; ++i) {
    const std::string word = argv[i];
    if (word.size() > 1 && word[0] == '-' && word.find('=') == word.size() - 1) {
      return word;
    }
  }
  return "";
}

int run(int argc, char** argv, AddCommands add_commands) {
  CLI::App app("Conservative visibility: what can be seen in a 3D scene, and what need not be drawn.",
               "sightline");
  app.set_version_flag("--version", "sightline " SIGHTLINE_VERSION);
  app.require_subcommand(1);
  app.footer(
      "SCENE is a file (.glb .gltf .obj .ply .stl ...) or a built-in scene: demo:city?copies=30&seed=1, "
      "demo:building, demo:boxes, demo:ship, demo:glass, demo:terrain?triangles=100000, demo:cave, "
      "demo:village, demo:jungle, demo:voxels, demo:boilerhouse, demo:toothpicks?n=200&scaling=ud, "
      "demo:canyon?grid=14.\n"
      "Exit code: 0 fine, 1 a check failed, 2 bad usage or input, 130 interrupted (Ctrl-C), 143 told to end "
      "(SIGTERM).\n"
      "sightline help COMMAND, or COMMAND --help, shows a command's options and examples.");
  Command chosen;
  add_commands(app, chosen);
  readDecimalsAlone(app);
  if (argc < 2) {
    fmt::print("{}", overview(app));
    return kOk;
  }
  if (const std::string word = argv[1]; !word.empty() && word[0] != '-' && !isCommand(app, word)) {
    return fail(noSuchCommand(app, word).message);
  }
  if (const std::string word = optionWithoutValue(argc, argv); !word.empty()) {
    return speaks(argc, argv) ? fail(word + " needs a value after the '='") : kOk;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return speaks(argc, argv) ? app.exit(help) : kOk;
  } catch (const CLI::ParseError& error) {
    return speaks(argc, argv) ? fail(whyRefused(app, error).message) : kOk;
  }
  if (speaks(argc, argv)) {
    endWhenTold(app.get_subcommands().front()->get_name());
  }
  const Result<ExitCode> result = chosen();
  if (result && std::fflush(stdout) != 0) {
    return fail("cannot write to standard output");
  }
  return result ? *result : fail(result.error().message);
}

}  // namespace

int runCommandLine(int argc, char** argv, AddCommands add_commands) {
  openStandardStreams();
  try {
    return run(argc, argv, add_commands);
  } catch (const std::bad_alloc&) {
    return fail("out of memory: the scene or the result is too large for this machine");
  } catch (const std::exception& error) {
    return fail(error.what());
  }
}

}  // namespace sightline::tool
