// sightline reproduce: repeats the experiments of a paper on the scenes of today.

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <limits>
#include <memory>

#include "sightline/pvs/format/visibility_octree.h"
#include "tools/sightline/command_line/command_line.h"
#include "tools/sightline/command_line/names.h"
#include "tools/sightline/commands.h"
#include "tools/sightline/reproduce/paper_run.h"
#include "tools/sightline/reproduce/paper_table.h"

namespace sightline::tool {
namespace {

std::vector<std::string> namesAndAll() {
  std::vector<std::string> names = paperNames();
  names.emplace_back(kAllPapers);
  return names;
}

}  // namespace

void addReproduce(CLI::App& app, Command& chosen) {
  CLI::App* command = app.add_subcommand("reproduce", "a paper's experiments, on the scenes of today");
  const auto options = std::make_shared<ReproduceOptions>();
  command
      ->add_option(
          "PAPER", options->paper,
          "the paper, by its authors; all: one after the other, each into a folder of its own in that of "
          "-o, with a page that leads to them; papers that are finished there are not run again")
      ->required()
      ->check(isOneOf(namesAndAll()));
  command
      ->add_option("--scene", options->scenes,
                   "a file or demo:NAME?key=value&...; several: once for each (default: the paper's)")
      ->type_name(kFileType)
      ->allow_extra_args(false);
  addOutputOptions(*command, options->output);
  addThreadsOption(*command, options->threads);
  addPathOptions(*command, options->path);
  addPictureOptions(*command, options->picture);
  for (const char* side : {"width", "height"}) {
    command->get_option(std::string("--") + side)
        ->description(fmt::format("{} of the pictures, pixels (default: the paper's or the path's)", side));
  }
  command->add_flag(
      "--short", options->fewer_frames,
      "few frames, unless --frames says which; experiments on stretches of the path have their own; of "
      "bittner and snyder-lengyel small pictures too, unless --height is given; of saona-vazquez a small "
      "ship and depth 4 as well, unless --scene and --depth say others");
  command->add_option("--depth", options->depth, "saona-vazquez: of the octree (default: 6)")
      ->check(CLI::Range(1u, kMaxOctreeDepth));
  command
      ->add_option("--triangle-budget", options->triangle_budget,
                   "saona-vazquez: of a leaf (default: that of `sightline bake`)")
      ->check(CLI::Range(std::uint64_t{1}, std::numeric_limits<std::uint64_t>::max() / 2));
  command
      ->add_option("-o,--output", options->folder,
                   "folder of the paper's page, its tables and a report for each scene; made if needed")
      ->type_name(kFolderType);
  command->footer(
      "poon-wang has routes of its own where the scene has walks best, average and worst, saona-vazquez "
      "where it has walk and random; --path takes the place of them.\n"
      "Examples:\n"
      "  sightline reproduce bittner -o report\n"
      "  sightline reproduce coorg-teller\n"
      "  sightline reproduce poon-wang -o report\n"
      "  sightline reproduce saona-vazquez --threads 8 -o report\n"
      "  sightline reproduce snyder-lengyel -o report\n"
      "  sightline reproduce all --short -o reports\n"
      "  sightline reproduce coorg-teller --short --scene \"demo:city?copies=4\" --json tables.json\n"
      "  sightline reproduce coorg-teller --scene office.glb --path walk.json -o report");
  command->callback([options, command, &chosen] {
    options->command_line = commandLine(*command);
    chosen = [options] { return options->paper == kAllPapers ? runAllPapers(*options) : runPaper(*options); };
  });
}

}  // namespace sightline::tool
