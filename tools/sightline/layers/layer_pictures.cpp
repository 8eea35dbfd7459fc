#include "tools/sightline/layers/layer_pictures.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>

#include "sightline/io/image.h"
#include "sightline/render/layer_compositor.h"
#include "tools/sightline/command_line/json_output.h"
#include "tools/sightline/command_line/names.h"
#include "tools/sightline/command_line/output_files.h"
#include "tools/sightline/layers/layer_by_distance.h"
#include "tools/sightline/layers/layer_recorder.h"
#include "tools/sightline/layers/layer_replacement.h"
#include "tools/sightline/layers/picture_difference.h"

namespace sightline::tool {
namespace {

constexpr std::array<Name<CompositeSettings::Peel>, 2> kPeels{{
    {"where-needed", CompositeSettings::Peel::kWhereNeeded},
    {"never", CompositeSettings::Peel::kNever},
}};

class LayerPictures : public FrameMaker {
 public:
  LayerPictures(const LayerPictureOptions& options, const FrameMakerInput& input, LayerRenderer renderer,
                std::vector<LayerReplacementFile> replaced)
      : options_(options),
        input_(input),
        scene_(input.input.moving.scene.view()),
        renderer_(std::move(renderer)),
        compositor_(scene_, renderer_),
        replaced_(std::move(replaced)) {}

  Result<Json> make(const SortedFrame& frame) override {
    renderer_.setTransforms(frame.scene_from_stored);
    renderer_.setPieces({frame.pieces.begin(), frame.pieces.end()});
    if (const Status ok = setUses(frame); !ok) {
      return ok.error();
    }
    if (!options_.layer_file.empty()) {
      recorder_.beginFrame();
      settings_.keep_group = [&](const CompositedGroup& group) {
        recorder_.add(group, frame, input_.input.moving.parts);
      };
    }
    const Result<CompositeStats> stats = compositor_.composite(frame.view, frame.layers, settings_, picture_);
    if (!stats) {
      return stats.error();
    }
    Json json = {{"layers", stats->layers},
                 {"peeled", stats->peeled},
                 {"triangles", stats->triangles},
                 {"without_order", unorderedGroups(frame)},
                 {"left_out", leftOutParts(frame)}};
    line_ = fmt::format("frame {}: {} layers drawn, {} of them peeled", frame.number, stats->layers,
                        stats->peeled);
    compareWithAllAtOnce(frame, json);
    if (!options_.by_distance.empty()) {
      if (const Status ok = compareWithDistances(frame, json); !ok) {
        return ok.error();
      }
    }
    line_ += unorderedText(json["without_order"]);
    lines_.push_back(line_);
    if (!options_.image.empty()) {
      const std::string file = frameFile(options_.image, frame.number, input_.several_frames);
      if (const Status ok = savePicture(toImage(picture_), file); !ok) {
        return ok.error();
      }
      json["file"] = file;
    }
    if (!options_.layer_file.empty()) {
      const std::string file = frameFile(options_.layer_file, frame.number, input_.several_frames);
      renderer_.drawSky(frame.view, sky_);
      recorder_.addSky(sky_);
      if (const Status ok = recorder_.write(file, frame, picture_); !ok) {
        return ok.error();
      }
      json["layer_file"] = file;
    }
    return Json{{"picture", json}};
  }

  void print() const override {
    for (const std::string& line : lines_) {
      fmt::print("{}\n", line);
    }
  }

 private:
  bool isWithout(PartId part) const {
    return std::find(options_.without.begin(), options_.without.end(), part.value) != options_.without.end();
  }

  // Finds the layers of the parts that the options name, and the objects to draw.
  Status setUses(const SortedFrame& frame) {
    settings_ = {};
    settings_.peel = valueOf(kPeels, options_.peel);
    settings_.form = input_.form;
    objects_.clear();
    drawn_.clear();
    for (std::uint32_t i = 0; i < frame.layers.layers(); ++i) {
      const LayerId layer(i);
      const std::span<const PartId> parts = frame.layers.partsOf(layer);
      if (std::any_of(parts.begin(), parts.end(), [&](PartId part) { return isWithout(part); })) {
        settings_.left_out.push_back(layer);
        continue;
      }
      for (const PartId part : parts) {
        objects_.push_back(ObjectId(frame.wholeOf(part).value));
        drawn_.push_back(ObjectId(part.value));
      }
      for (LayerReplacementFile& replaced : replaced_) {
        if (std::find(parts.begin(), parts.end(), PartId(replaced.part)) != parts.end()) {
          if (const Status ok = prepare(replaced, frame); !ok) {
            return ok;
          }
          settings_.replaced.push_back({layer, &replaced.image});
        }
      }
    }
    std::sort(objects_.begin(), objects_.end());
    objects_.erase(std::unique(objects_.begin(), objects_.end()), objects_.end());
    return Success{};
  }

  // Reads this frame's file and fits it: as it is if it has the pictures' size, else stretched over the
  // part's rectangle.
  Status prepare(LayerReplacementFile& replaced, const SortedFrame& frame) {
    if (const Status ok = replaced.read(frame.number); !ok) {
      return ok;
    }
    LayerImage& image = replaced.image;
    if (!replaced.hasSize(input_.width, input_.height)) {
      const ObjectId object(replaced.part);
      renderer_.draw(frame.view, {&object, 1}, {}, image);
      replaced.fitOver(image);
    } else {
      image.clear(input_.width, input_.height);
      replaced.fill(image);
    }
    return Success{};
  }

  void compareWithAllAtOnce(const SortedFrame& frame, Json& json) {
    if (!settings_.replaced.empty()) {
      return;
    }
    // A part is drawn whole, unless some of its pieces were left out with a layer.
    renderer_.draw(frame.view, settings_.left_out.empty() ? objects_ : drawn_, {.peel = true}, other_);
    addSky(frame.view, other_);
    const PictureDifference difference = measureDifference(picture_, other_, kDifferenceTolerance);
    json["difference"] = differenceJson(difference);
    line_ += "; mean difference from all objects drawn at once " + differenceText(difference);
  }

  Status compareWithDistances(const SortedFrame& frame, Json& json) {
    const DistanceOrder order = orderByDistance(scene_, frame.view, objects_, frame.scene_from_stored);
    drawByDistance(renderer_, frame.view, order, other_);
    addSky(frame.view, other_);
    const DistancePairs pairs = countWrongPairs(renderer_, frame.view, order);
    const PictureDifference difference = measureDifference(picture_, other_, kDifferenceTolerance);
    const std::string file = frameFile(options_.by_distance, frame.number, input_.several_frames);
    json["by_distance"] = {{"file", file},
                           {"overlapping_pairs", pairs.overlapping},
                           {"wrong_pairs", pairs.wrong},
                           {"pairs_without_order", pairs.without_order},
                           {"difference", differenceJson(difference)}};
    line_ += fmt::format(
        "; by distances of centres {} of {} overlapping pairs of see-through parts are in the wrong order "
        "({} have no order), mean difference {}",
        pairs.wrong, pairs.overlapping, pairs.without_order, differenceText(difference));
    return writeComparison(picture_, other_, file);
  }

  void addSky(const View& view, LayerImage& image) {
    renderer_.drawSky(view, sky_);
    compositeOver(image, sky_);
  }

  bool isBlended(PartId part) const {
    return scene_.materialOf(scene_.objects[part.value]).opacity == Opacity::kBlended;
  }
  const std::string& nameOf(PartId part) const { return input_.input.moving.parts[part.value].name; }

  // Returns the drawn parts of groups for which no order is right.
  Json unorderedGroups(const SortedFrame& frame) const {
    Json groups = Json::array();
    for (const std::uint32_t g : compositor_.unorderedGroups()) {
      Json& parts = groups.emplace_back(Json::array());
      for (std::uint32_t i = frame.layers.first_layer[g]; i < frame.layers.first_layer[g + 1]; ++i) {
        if (isDrawn(LayerId(i))) {
          for (const PartId number : frame.layers.partsOf(LayerId(i))) {
            const PartId part = frame.wholeOf(number);
            Json entry = {{"part", part.value}, {"name", nameOf(part)}, {"see_through", isBlended(part)}};
            if (std::find(parts.begin(), parts.end(), entry) == parts.end()) {  // or another piece of it is
              parts.push_back(std::move(entry));
            }
          }
        }
      }
    }
    return groups;
  }

  bool isDrawn(LayerId layer) const {
    const auto is_layer = [&](const LayerReplacement& replaced) { return replaced.layer == layer; };
    return std::find(settings_.left_out.begin(), settings_.left_out.end(), layer) ==
               settings_.left_out.end() &&
           std::none_of(settings_.replaced.begin(), settings_.replaced.end(), is_layer);
  }

  // Returns the parts left out, which include other parts of the same layers.
  Json leftOutParts(const SortedFrame& frame) const {
    std::vector<std::uint32_t> parts;
    for (const LayerId layer : settings_.left_out) {
      for (const PartId part : frame.layers.partsOf(layer)) {
        parts.push_back(frame.wholeOf(part).value);
      }
    }
    std::sort(parts.begin(), parts.end());
    parts.erase(std::unique(parts.begin(), parts.end()), parts.end());
    return parts;
  }

  // Returns the first see-through parts of each group, as in "12 pane"; the JSON has all parts.
  static std::string unorderedText(const Json& groups) {
    constexpr std::size_t kMaxNames = 8;
    std::string text;
    for (const Json& group : groups) {
      std::vector<std::string> names;
      std::size_t see_through = 0;
      for (const Json& part : group) {
        if (part["see_through"].get<bool>() && ++see_through <= kMaxNames) {
          names.push_back(
              fmt::format("{} {}", part["part"].get<std::uint32_t>(), part["name"].get<std::string>()));
        }
      }
      text += fmt::format("{} {} parts, see-through of them: {}", text.empty() ? "; no order among" : " |",
                          group.size(), fmt::join(names, ", "));
      if (see_through > kMaxNames) {
        text += fmt::format(" and {} more", see_through - kMaxNames);
      }
    }
    return text;
  }

  const LayerPictureOptions& options_;
  const FrameMakerInput& input_;
  SceneView scene_;
  LayerRenderer renderer_;
  LayerCompositor compositor_;
  CompositeSettings settings_;
  std::vector<LayerReplacementFile> replaced_;
  std::vector<ObjectId> objects_;  // this frame's objects, whole, without those left out, ascending
  std::vector<ObjectId> drawn_;    // the same with divided objects piece by piece, in any order
  LayerImage picture_, other_, sky_;
  LayerRecorder recorder_;
  std::string line_;
  std::vector<std::string> lines_;
};

Status checkOptions(const LayerPictureOptions& options, const FrameMakerInput& input) {
  for (const std::uint32_t part : options.without) {
    if (const Status ok = checkPartNumber("--without", part, input.input.moving.parts.size()); !ok) {
      return ok;
    }
  }
  return Success{};
}

}  // namespace

void addLayerPictureOptions(CLI::App& command, LayerPictureOptions& options) {
  command
      .add_option(
          "--image", options.image,
          "write a picture of each frame, composited from layers, to this .png file; of several frames, the "
          "frame's number goes before .png")
      ->type_name(kFileType)
      ->check(isNotEmpty());
  command
      .add_option("--layer-file", options.layer_file,
                  "write the images of each frame's layers, with opacity, depths and the program that "
                  "composites them, to this OpenEXR file")
      ->type_name(kFileType)
      ->check(isNotEmpty());
  CLI::Option* by_distance = command.add_option(
      "--by-distance", options.by_distance,
      "write the picture, beside it the one with see-through parts ordered by distances of their centres, "
      "and where they differ, to this .png file");
  by_distance->type_name(kFileType)->check(isNotEmpty());
  command
      .add_option("--peel", options.peel,
                  "depth peeling of see-through parts whose order is not known (else they are drawn by "
                  "number)")
      ->check(isOneOf(textsOf(kPeels)))
      ->capture_default_str();
  command.add_option("--without", options.without, "leave out the layers of these parts, by number")
      ->check(isNotEmpty())
      ->delimiter(',')
      ->allow_extra_args(false);
  command
      .add_option(
          "--replace", options.replace,
          "PART=FILE.png: the file's picture (sRGB) in place of the part's layer; stretched over what "
          "the part covers, unless it has the whole picture's size. FILE_####.png: a sequence, with "
          "the frame's number in place of the #")
      ->allow_extra_args(false)
      ->excludes(by_distance);
}

Result<std::unique_ptr<FrameMaker>> makeLayerPictures(const LayerPictureOptions& options,
                                                      const FrameMakerInput& input) {
  if (options.image.empty() && options.by_distance.empty() && options.layer_file.empty()) {
    if (options != LayerPictureOptions{}) {
      return Error{"--without, --replace and --peel change pictures; give --image too"};
    }
    return std::unique_ptr<FrameMaker>();
  }
  if (const Status ok = checkOptions(options, input); !ok) {
    return ok.error();
  }
  Result<std::vector<LayerReplacementFile>> replaced =
      replacementFiles(options.replace, options.without, input.input);
  if (!replaced) {
    return replaced.error();
  }
  Result<LayerRenderer> renderer = makeRenderer(input);
  if (!renderer) {
    return renderer.error();
  }
  return std::unique_ptr<FrameMaker>(
      std::make_unique<LayerPictures>(options, input, std::move(*renderer), std::move(*replaced)));
}

}  // namespace sightline::tool
