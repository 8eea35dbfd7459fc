// sightline layers: the order in which the parts of a scene must be drawn, in every frame of a camera path.

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>

#include "sightline/layers/compositing.h"
#include "sightline/layers/convex_pieces.h"
#include "src/base/stopwatch.h"
#include "tools/sightline/command_line/json_output.h"
#include "tools/sightline/command_line/names.h"
#include "tools/sightline/command_line/parse_text.h"
#include "tools/sightline/command_line/progress_bar.h"
#include "tools/sightline/command_line/signals.h"
#include "tools/sightline/commands.h"
#include "tools/sightline/layers/layer_checks.h"
#include "tools/sightline/layers/layer_drawings.h"
#include "tools/sightline/layers/layer_eyes.h"
#include "tools/sightline/layers/layer_frames.h"
#include "tools/sightline/layers/layer_lens.h"
#include "tools/sightline/layers/layer_line_picture.h"
#include "tools/sightline/layers/layer_pictures.h"
#include "tools/sightline/layers/layer_seen_arcs.h"
#include "tools/sightline/layers/layer_sort_options.h"
#include "tools/sightline/layers/layer_splitting.h"
#include "tools/sightline/layers/layer_totals.h"
#include "tools/sightline/layers/layers_options.h"

namespace sightline::tool {
namespace {

constexpr std::uint32_t kMaxSplitPieces = 100000;

using FrameMakers = std::vector<std::unique_ptr<FrameMaker>>;

template <typename Tag>
std::vector<std::uint32_t> numbersOf(std::span<const Id<Tag>> ids) {
  std::vector<std::uint32_t> numbers;
  for (const Id<Tag> id : ids) {
    numbers.push_back(id.value);
  }
  return numbers;
}

Json pairsJson(std::span<const LayerArc> pairs) {
  Json json = Json::array();
  for (const LayerArc& pair : pairs) {
    json.push_back({pair.front.value, pair.back.value});
  }
  return json;
}

Json orderJson(const LayerOrder& order) {
  Json json = Json::array();
  for (std::size_t i = 0; i < order.groups(); ++i) {
    json.push_back(numbersOf(order.group(i)));
  }
  return json;
}

Json layersJson(const FrameLayers& layers) {
  Json json = Json::array();
  for (std::uint32_t layer = 0; layer < layers.layers(); ++layer) {
    json.push_back(numbersOf(layers.partsOf(LayerId(layer))));
  }
  return json;
}

Json programJson(const CompositingProgram& program) {
  Json json = Json::array();
  for (const CompositingStep& step : program.steps) {
    json.push_back(describe(step));
  }
  return json;
}

Json frameJson(std::uint32_t frame, const LayerOrder& order, const FrameLayers& layers,
               const CompositingProgram& program, double sort_us, const std::string& search) {
  const LayerStats& stats = order.stats;
  return {{"frame", frame},
          {"order", orderJson(order)},
          {"arcs", pairsJson(order.arcs)},
          {"collisions", pairsJson(order.collisions)},
          {"depth_buffered", layers.depth_buffered.valid() ? Json(layers.depth_buffered.value) : Json()},
          {"layers", layersJson(layers)},
          {"program", programJson(program)},
          {"sort_us", sort_us},
          {"occluder_queries", stats.occluder_queries},
          {"candidates", stats.candidates},
          {"pair_queries", stats.pair_queries},
          {"reinsertions", stats.reinsertions},
          {"search", search}};
}

void print(const LayerTotals& totals, std::size_t parts) {
  const auto line = [](const char* what, double value, int decimals = 1) {
    fmt::print("  {:<38}{:12.{}f}\n", what, value, decimals);
  };
  fmt::print("{} parts, {} frames, means of a frame:\n", parts, totals.frames());
  line("groups", totals.mean(&LayerTotals::Frame::groups));
  line("of them with more than one part, %", 100.0 * totals.mean(&LayerTotals::Frame::grouped_share), 2);
  line("parts in those, %", 100.0 * totals.mean(&LayerTotals::Frame::parts_in_groups_share), 2);
  line("parts left to the depth buffer", totals.mean(&LayerTotals::Frame::depth_buffered));
  line("parts outside the view, left out", totals.mean(&LayerTotals::Frame::outside));
  line("largest group", totals.mean(&LayerTotals::Frame::largest));
  line("layers", totals.mean(&LayerTotals::Frame::layers));
  line("arcs", totals.mean(&LayerTotals::Frame::arcs));
  line("collisions", totals.mean(&LayerTotals::Frame::collisions));
  line("compositing operations", totals.mean(&LayerTotals::Frame::operations));
  line("pairs tested exactly", totals.mean(&LayerTotals::Frame::pair_queries));
  line("sort time, us", totals.mean(&LayerTotals::Frame::sort_us));
  line("sort time, largest, us", totals.largest(&LayerTotals::Frame::sort_us));
}

// Makes all that the options ask to make of sorted frames besides JSON.
Result<FrameMakers> makersOf(const LayersOptions& options, const FrameMakerInput& input) {
  FrameMakers makers;
  Result<std::unique_ptr<FrameMaker>> made[] = {
      makeLayerPictures(options.pictures, input), makeLayerLens(options.lens, input),
      makeLayerDrawings(options.drawings, input), makeLinePicture(options.drawings, input)};
  for (Result<std::unique_ptr<FrameMaker>>& maker : made) {
    if (!maker) {
      return maker.error();
    }
    if (*maker != nullptr) {
      makers.push_back(std::move(*maker));
    }
  }
  return makers;
}

double aspectOf(const PictureOptions& size) {
  return static_cast<double>(size.width) / static_cast<double>(size.height);
}

// Parts of which a layer is left out or replaced, which needs them whole.
std::vector<std::uint32_t> namedParts(const LayersOptions& options) {
  std::vector<std::uint32_t> parts = options.pictures.without;
  for (const std::string& text : options.pictures.replace) {
    if (const std::optional<std::uint32_t> part = parseWhole(text.substr(0, text.find('=')))) {
      parts.push_back(*part);
    }
  }
  return parts;
}

// Sorts the frames of a camera path one after the other.
class WalkSorter {
 public:
  // seen: null if the order is that of hulls.
  WalkSorter(const LayersOptions& options, const LayerInput& input, const FrameMakers& makers, SeenArcs* seen)
      : options_(options),
        input_(input),
        makers_(makers),
        seen_(seen),
        aspect_(aspectOf(pictureSize(options.size, input.walk.path))),
        sorter_(options.eyes, options.lens, input, settingsOf(options.sort, needAllArcs(options.drawings))) {
    if (options.split_cycles > 0) {
      const bool by_triangles = !input.moving.pose && options.division.max_pieces == 1;
      cycles_.emplace(options.eyes, options.lens, input, settingsOf(options.sort, false),
                      options.split_cycles, namedParts(options), by_triangles);
    }
  }

  // Sorts a frame and makes its files. progress: called with the share of the frame that is done.
  Status sort(std::uint32_t frame, const std::function<void(double)>& progress) {
    View view = input_.walk.view(frame, input_.moving.scene);
    view.aspect = aspect_;
    sorter_.place(frame, view);
    base::Stopwatch watch;
    const LayerOrder& of_hulls = sorter_.sort(view);
    const double sort_us = options_.no_times ? 0.0 : watch.lap();
    if (!makers_.empty() || seen_ != nullptr) {
      placements(input_.moving, frame, scene_from_stored_);
    }
    Json json;
    const LayerOrder& order = cycles_            ? divide(frame, view, of_hulls, json)
                              : seen_ != nullptr ? seen_->sort(view, of_hulls, scene_from_stored_)
                                                 : of_hulls;
    const FrameLayers& layers = merger_.merge(order);
    const CompositingProgram& program = compiler_.compile(layers, formOf(options_.sort));
    totals_.add(order, static_cast<double>(layers.layers()),
                static_cast<double>(countSteps(program.steps).operations()), sort_us);
    if (!options_.common.json.empty()) {
      json.update(frameJson(frame, order, layers, program, sort_us, options_.sort.search));
    }
    for (std::size_t i = 0; i < makers_.size(); ++i) {
      const auto progressOf = [&](double done) {
        progress((static_cast<double>(i) + done) / static_cast<double>(makers_.size()));
      };
      const Result<Json> made =
          makers_[i]->make({frame, view, order, layers, scene_from_stored_, pieces_, progressOf});
      if (!made) {
        return made.error();
      }
      json.update(*made);
    }
    if (!options_.common.json.empty()) {
      frames_.push_back(dump(json));
    }
    return Success{};
  }

  const LayerTotals& totals() const { return totals_; }
  const std::vector<std::string>& frames() const { return frames_; }  // as JSON
  void printCycles() const {
    if (cycles_) {
      cycles_->print();
    }
  }

 private:
  // Sorts the frame again, with parts in cycles divided.
  const LayerOrder& divide(std::uint32_t frame, const View& view, const LayerOrder& whole, Json& json) {
    cycles_->place(frame, view);
    base::Stopwatch watch;
    const LayerOrder& order = cycles_->sort(view);
    const double split_us = options_.no_times ? 0.0 : watch.lap();
    json["split"] = cycles_->figures(whole, order, split_us);
    scenePoses(input_.moving, frame, scene_from_part_);
    pieces_ = objectPieces(cycles_->pieces(), scene_from_part_);
    return order;
  }

  const LayersOptions& options_;
  const LayerInput& input_;
  const FrameMakers& makers_;
  SeenArcs* seen_;
  double aspect_;  // aspect of the pictures
  EyeSorter sorter_;
  LayerMerger merger_;
  CompositingCompiler compiler_;
  std::optional<CycleWalk> cycles_;
  std::vector<ObjectPiece> pieces_;
  std::vector<Mat4> scene_from_stored_, scene_from_part_;
  LayerTotals totals_;
  std::vector<std::string> frames_;
};

Result<ExitCode> sortWalk(const LayersOptions& options, const LayerInput& input, const FrameMakers& makers,
                          SeenArcs* seen) {
  WalkSorter sorter(options, input, makers, seen);
  const std::vector<std::uint32_t>& frames = input.walk.frames;
  ProgressBar progress(makers.empty() ? "sorting" : "sorting and drawing");
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const auto progressOf = [&](double done) {
      progress.update((static_cast<double>(i) + done) / static_cast<double>(frames.size()));
    };
    if (const Status ok = sorter.sort(frames[i], progressOf); !ok) {
      return ok.error();
    }
    progressOf(1.0);
  }
  Json chosen = optionsJson(options.sort);
  chosen["parts"] = nameOf(kPartChoices, partChoiceOf(options));
  chosen["pieces"] = options.division.max_pieces;
  chosen["pre_split"] = options.division.split_width;
  chosen["pre_split_overlap"] = options.division.split_overlap;
  chosen["split_cycles"] = options.split_cycles;
  chosen["order_for"] = orderFor(options.eyes, options.lens);
  chosen["stereo"] = options.eyes.stereo;
  const Json head = {
      {"scene", sceneJson(input.moving.scene)}, {"parts", input.moving.parts.size()}, {"options", chosen}};
  if (const Status ok = writeOutput(options.common.json, dumpWithList(head, "frames", sorter.frames()));
      !ok) {
    return ok.error();
  }
  if (options.common.textOnStdout()) {
    print(sorter.totals(), input.moving.parts.size());
    sorter.printCycles();
    if (seen != nullptr) {
      fmt::print("  the order is that of the pixels of each picture, approximate at a pixel\n");
    }
    for (const std::unique_ptr<FrameMaker>& maker : makers) {
      maker->print();
    }
  }
  return kOk;
}

// Lets the depth buffer take care of the opaque parts, except those that have a place already or that
// --without names.
void leaveToDepthBuffer(const LayersOptions& options, MovingScene& moving) {
  const std::vector<std::uint32_t>& named = options.pictures.without;
  for (std::uint32_t part = 0; part < moving.parts.size(); ++part) {
    PartSettings::Place& place = moving.parts[part].settings.place;
    const SceneView scene = moving.scene.view();
    if (place == PartSettings::Place::kSorted &&
        scene.materialOf(scene.objects[part]).opacity != Opacity::kBlended &&
        std::find(named.begin(), named.end(), part) == named.end()) {
      place = PartSettings::Place::kDepthBuffered;
    }
  }
}

Result<ExitCode> runLayers(const LayersOptions& options) {
  if (const Status ok = checkLayersOptions(options); !ok) {
    return ok.error();
  }
  Result<LayerInput> input =
      loadLayerInput(options.common.scene, options.path, options.places, options.division);
  if (!input) {
    return input.error();
  }
  if (const Status ok = checkFilesOfFrames(options, input->walk.frames); !ok) {
    return ok.error();
  }
  if (partChoiceOf(options) == PartChoice::kSeeThrough) {
    leaveToDepthBuffer(options, input->moving);
  }
  const PictureOptions size = pictureSize(options.size, input->walk.path);
  const FrameMakerInput made_from{.input = *input,
                                  .scene_file = options.common.scene,
                                  .width = size.width,
                                  .height = size.height,
                                  .samples = options.samples,
                                  .tints = valueOf(kSwitch, options.tints),
                                  .form = formOf(options.sort),
                                  .seen_first = sortsBySeen(options.sort),
                                  .several_frames = input->walk.frames.size() > 1};
  const Result<FrameMakers> makers = makersOf(options, made_from);
  if (!makers) {
    return makers.error();
  }
  if (!makers->empty()) {
    keepWhenTold("pictures and drawings that were finished are kept, and no JSON is written");
  }
  std::optional<SeenArcs> seen;
  if (sortsBySeen(options.sort) && !isDrawn(options)) {
    Result<SeenArcs> created = SeenArcs::create(made_from);
    if (!created) {
      return created.error();
    }
    seen.emplace(std::move(*created));
  }
  return sortWalk(options, *input, *makers, seen ? &*seen : nullptr);
}

void addPartOptions(CLI::App& command, LayersOptions& options) {
  command
      .add_option("--parts", options.parts,
                  "which parts are sorted: all, or the see-through ones, if a depth buffer takes care of the "
                  "others (default: see-through for --image and --by-distance alone, else all)")
      ->check(isOneOf(textsOf(kPartChoices)));
  command
      .add_option("--pieces", options.division.max_pieces,
                  "hulls that stand for each object at most, of convex pieces of it: objects with holes or "
                  "bends are then grouped with fewer others (1: its hull)")
      ->check(CLI::Range(1u, kMaxConvexPieces))
      ->capture_default_str();
  addDecimalOption(command, "--pre-split", options.division.split_width, 0.0, 1e9,
                   "cut opaque objects that are wider than so many metres by a grid of that width into "
                   "overlapping parts, before anything is sorted (0: objects stay whole)");
  addDecimalOption(command, "--pre-split-overlap", options.division.split_overlap, 0.0, 1.0,
                   "by how much the parts of --pre-split overlap, as a fraction of its width");
  command
      .add_option("--split-cycles", options.split_cycles,
                  "divide parts in cycles by planes through them, while they are in a cycle, into this many "
                  "pieces of all parts at most, so that groups fall apart (0: parts stay whole)")
      ->check(CLI::Range(0u, kMaxSplitPieces))
      ->capture_default_str();
  command.add_option("--backdrop", options.places.backdrops, "parts behind all others, by number")
      ->check(isNotEmpty())
      ->delimiter(',');
  command.add_option("--overlay", options.places.overlays, "parts before all others, by number")
      ->check(isNotEmpty())
      ->delimiter(',');
}

}  // namespace

void addLayers(CLI::App& app, Command& chosen) {
  CLI::App* command = app.add_subcommand(
      "layers", "the order in which parts must be drawn, cycles, and compositing programs, frame by frame");
  const auto options = std::make_shared<LayersOptions>();
  addSceneOptions(*command, options->common);
  addPathOptions(*command, options->path);
  for (const char* option : {"SCENE", "--json"}) {
    command->get_option(option)->check(isNotEmpty());
  }
  addPartOptions(*command, *options);
  addLayerSortOptions(*command, options->sort);
  addLayerEyeOptions(*command, options->eyes);
  addLayerPictureOptions(*command, options->pictures);
  addLayerLensOptions(*command, options->lens);
  addLayerDrawingOptions(*command, options->drawings);
  addPictureOptions(*command, options->size);
  command->add_option("--samples", options->samples, "a side of each pixel of the pictures: 1, 2 or 4")
      ->check(isOneOf({"1", "2", "4"}))
      ->capture_default_str();
  command
      ->add_option("--tints", options->tints,
                   "pictures: objects of one material differ a little in lightness; off: where objects "
                   "overlap in one surface, it does not matter which of them is drawn")
      ->check(isOneOf(textsOf(kSwitch)))
      ->capture_default_str();
  command->add_flag("--no-times", options->no_times, "write all times as 0: runs can be compared bit by bit");
  command->footer(
      "A part is an object of the scene, taken as its convex hull or as those of its pieces. Groups are "
      "parts that occlude each other "
      "in a cycle; layers, what must be drawn together within them. Of several frames each "
      "picture or drawing has the frame's number before its ending.\n"
      "Examples:\n"
      "  sightline layers demo:toothpicks --json order.json\n"
      "  sightline layers \"demo:toothpicks?n=1600&scaling=ud\" --sort incremental\n"
      "  sightline layers demo:canyon --extents world --expression over-atop --json -\n"
      "  sightline layers demo:glass --frames 100 --image glass.png --by-distance compared.png\n"
      "  sightline layers demo:canyon --frames 0:250:50 --width 640 --height 360 --samples 4 --image "
      "canyon.png\n"
      "  sightline layers demo:glass --frames 100 --image part.png --without 12,13 --replace 3=poster.png\n"
      "  sightline layers demo:glass --frames 100 --layer-file glass.exr\n"
      "  sightline layers demo:toothpicks --frames 100 --depth-of-field layers --focus 3 --aperture 0.06 "
      "--blurred out.png\n"
      "  sightline layers demo:city --frames 0 --svg city.svg --pdf city.pdf\n"
      "  sightline layers demo:city --frames 0 --plot --svg plot.svg\n"
      "  sightline layers demo:glass --stereo 0.065 --pieces 8\n"
      "  sightline layers demo:toothpicks --split-cycles 64\n"
      "  sightline layers model.glb --path walk.json --arcs all --backdrop 0");
  command->callback([options, &chosen] { chosen = [options] { return runLayers(*options); }; });
}

}  // namespace sightline::tool
