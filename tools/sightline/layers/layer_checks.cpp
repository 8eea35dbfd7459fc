#include "tools/sightline/layers/layer_checks.h"

#include <fmt/format.h>

#include <algorithm>

#include "tools/sightline/command_line/output_files.h"
#include "tools/sightline/layers/layer_replacement.h"

namespace sightline::tool {
namespace {

// An option, and whether the command line has it.
struct GivenOption {
  const char* option;
  bool given;
};
using GivenOptions = std::vector<GivenOption>;

// Where `first` is given, refuses the first of the others that is given too. reason: with {} for its name.
Status refusePairs(bool first, const GivenOptions& others, fmt::format_string<const char*&> reason) {
  const auto other =
      std::find_if(others.begin(), others.end(), [](const GivenOption& option) { return option.given; });
  if (!first || other == others.end()) {
    return Success{};
  }
  const char* option = other->option;
  return Error{fmt::format(reason, option)};
}

// The options that need a layer of its own for each opaque part, and whether they were given.
GivenOptions needOpaqueLayers(const LayersOptions& options) {
  return {{"--replace", !options.pictures.replace.empty()},
          {"--blurred", !options.lens.blurred.empty()},
          {"--compare", !options.lens.compare.empty()},
          {"--arcs seen", sortsBySeen(options.sort)},
          {"--svg", !options.drawings.svg.empty()},
          {"--pdf", !options.drawings.pdf.empty()},
          {"--line-picture", !options.drawings.line_picture.empty()}};
}

std::vector<NamedFile> outputsOf(const LayersOptions& options) {
  return {{"--json", options.common.json},
          {"--image", options.pictures.image, ".png"},
          {"--layer-file", options.pictures.layer_file, ".exr"},
          {"--by-distance", options.pictures.by_distance, ".png"},
          {"--blurred", options.lens.blurred, ".png"},
          {"--compare", options.lens.compare, ".png"},
          {"--svg", options.drawings.svg, ".svg"},
          {"--pdf", options.drawings.pdf, ".pdf"},
          {"--line-picture", options.drawings.line_picture, ".png"}};
}

// frames: those whose pictures are read if --replace names a sequence; empty: not known yet.
Status checkFilesOf(const LayersOptions& options, const std::vector<NamedFile>& outputs,
                    const std::vector<std::uint32_t>& frames = {}) {
  std::vector<NamedFile> inputs = walkInputs(options.common.scene, options.path);
  for (const std::string& replace : options.pictures.replace) {
    const std::size_t equals = std::min(replace.find('='), replace.size() - 1);
    const std::string pattern = replace.substr(equals + 1);
    inputs.push_back({"--replace", pattern});
    for (const std::uint32_t frame : frames) {
      inputs.push_back({"--replace", replacementFile(pattern, frame)});
    }
  }
  return checkFiles({.scenes = {options.common.scene}, .inputs = inputs, .outputs = outputs});
}

Status checkPictureOptions(const LayersOptions& options) {
  const bool any_picture = !options.pictures.image.empty() || !options.pictures.by_distance.empty() ||
                           !options.pictures.layer_file.empty() || !options.lens.blurred.empty() ||
                           !options.lens.compare.empty();
  const bool any_option = options.samples != 1 || options.tints != "on";
  return any_picture || !any_option
             ? Status(Success{})
             : Error{
                   "--samples and --tints: go with --image, --layer-file, --by-distance, --blurred or "
                   "--compare"};
}

Status checkPartChoice(const LayersOptions& options) {
  return refusePairs(partChoiceOf(options) == PartChoice::kSeeThrough, needOpaqueLayers(options),
                     "--parts see-through: draws opaque parts together, and {} needs a layer of each");
}

// What the pixels of one picture show says nothing of other eyes.
Status checkSeenArcs(const LayersOptions& options) {
  return refusePairs(
      sortsBySeen(options.sort),
      {{"--blurred", !options.lens.blurred.empty()},
       {"--compare", !options.lens.compare.empty()},
       {"--order-for lens", options.eyes.order_for == "lens"},
       {"--stereo", options.eyes.stereo != 0.0}},
      "--arcs seen: is an order of one picture's pixels, and {} needs more; leave one of the two out");
}

// Drawings have an order of their own, by outlines.
Status checkSeenOutlines(const LayersOptions& options) {
  return refusePairs(sortsBySeen(options.sort) && isDrawn(options),
                     {{"--image", !options.pictures.image.empty()},
                      {"--layer-file", !options.pictures.layer_file.empty()},
                      {"--by-distance", !options.pictures.by_distance.empty()},
                      {"--plot", options.drawings.plot}},
                     "--arcs seen: is an order by outlines for --svg and --pdf, which {} does not take; "
                     "leave one of the two out");
}

// Pieces are drawn by pictures alone, and a sample of a pixel is in one piece only.
Status checkSplitCycles(const LayersOptions& options) {
  return refusePairs(options.split_cycles > 0,
                     {{"--arcs seen", sortsBySeen(options.sort)},
                      {"--exact off", !valueOf(kSwitch, options.sort.exact)},
                      {"--order-for lens", options.eyes.order_for == "lens"},
                      {"--samples", options.samples != 1},
                      {"--blurred", !options.lens.blurred.empty()},
                      {"--compare", !options.lens.compare.empty()},
                      {"--svg", !options.drawings.svg.empty()},
                      {"--pdf", !options.drawings.pdf.empty()},
                      {"--line-picture", !options.drawings.line_picture.empty()}},
                     "--split-cycles: does not go with {}; leave one of the two out");
}

// Drawings would show the cuts as lines.
Status checkPreSplit(const LayersOptions& options) {
  return refusePairs(options.division.split_width > 0.0,
                     {{"--svg", !options.drawings.svg.empty()},
                      {"--pdf", !options.drawings.pdf.empty()},
                      {"--line-picture", !options.drawings.line_picture.empty()}},
                     "--pre-split: does not go with {}, which would draw the cuts");
}

}  // namespace

// A picture needs only see-through parts in order, since the depth buffer takes care of the opaque ones.
PartChoice partChoiceOf(const LayersOptions& options) {
  if (!options.parts.empty()) {
    return valueOf(kPartChoices, options.parts);
  }
  const auto needed = needOpaqueLayers(options);
  const bool picture = !options.pictures.image.empty() || !options.pictures.by_distance.empty();
  return picture && options.pictures.layer_file.empty() &&
                 std::none_of(needed.begin(), needed.end(), [](const GivenOption& n) { return n.given; })
             ? PartChoice::kSeeThrough
             : PartChoice::kAll;
}

bool isDrawn(const LayersOptions& options) {
  return !options.drawings.svg.empty() || !options.drawings.pdf.empty();
}

Status checkLayersOptions(const LayersOptions& options) {
  for (const Status& ok : {checkFilesOf(options, outputsOf(options)), checkPictureOptions(options),
                           checkPartChoice(options), checkSeenArcs(options), checkSeenOutlines(options),
                           checkSplitCycles(options), checkPreSplit(options)}) {
    if (!ok) {
      return ok;
    }
  }
  return Success{};
}

Status checkFilesOfFrames(const LayersOptions& options, const std::vector<std::uint32_t>& frames) {
  std::vector<NamedFile> outputs;
  for (const NamedFile& output : outputsOf(options)) {
    if (output.file.empty()) {
      continue;
    }
    if (output.option == "--json") {
      outputs.push_back(output);  // one file for all frames
      continue;
    }
    for (const std::uint32_t frame : frames) {
      outputs.push_back({output.option, frameFile(output.file, frame, frames.size() > 1), output.extension});
    }
  }
  return checkFilesOf(options, outputs, frames);
}

}  // namespace sightline::tool
