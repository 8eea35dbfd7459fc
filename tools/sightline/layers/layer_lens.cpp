#include "tools/sightline/layers/layer_lens.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "sightline/io/image.h"
#include "sightline/render/lens_picture.h"
#include "tools/sightline/command_line/names.h"
#include "tools/sightline/command_line/output_files.h"
#include "tools/sightline/command_line/parse_text.h"
#include "tools/sightline/layers/picture_difference.h"

namespace sightline::tool {
namespace {

constexpr std::array<Name<LensMethod>, 4> kLensMethods{{
    {"layers", LensMethod::kLayers},
    {"potmesil", LensMethod::kSingleNormalised},
    {"rokita", LensMethod::kSingleUnnormalised},
    {"accumulation", LensMethod::kAccumulation},
}};
constexpr std::array<Name<LayerBlur>, 3> kLayerBlurs{{
    {"even", LayerBlur::kEven},
    {"depth", LayerBlur::kByDepth},
    {"accumulate", LayerBlur::kAccumulate},
}};
constexpr std::uint32_t kMaxPasses = 10000;

// Motion blur without depth of field is done by layers.
std::string methodName(const LayerLensOptions& options) {
  return options.depth_of_field.empty() ? "layers" : options.depth_of_field;
}

class LayerLens : public FrameMaker {
 public:
  LayerLens(const LayerLensOptions& options, const FrameMakerInput& input, LayerRenderer renderer,
            LensSettings settings)
      : options_(options),
        input_(input),
        renderer_(std::move(renderer)),
        lens_(input.input.moving.scene.view(), renderer_),
        settings_(std::move(settings)) {}

  Result<Json> make(const SortedFrame& frame) override {
    renderer_.setTransforms(frame.scene_from_stored);
    setMotion(frame);
    const double share = options_.compare.empty() ? 1.0 : 0.5;
    LensSettings settings = settings_;
    settings.progress = [&](double done) { frame.progress(share * done); };
    const Result<LensStats> stats = lens_.draw(frame.view, frame.layers, settings, picture_);
    if (!stats) {
      return stats.error();
    }
    Json json = statsJson(*stats);
    std::string line = fmt::format("frame {}: {}, {} images drawn", frame.number, methodName(options_),
                                   stats->render_passes);
    if (settings_.method == LensMethod::kLayers) {
      line += fmt::format(" ({} layers: {} blurred evenly, {} by depth, {} accumulated)", stats->layers,
                          stats->even, stats->by_depth, stats->accumulated);
    }
    if (!options_.blurred.empty()) {
      const std::string file = frameFile(options_.blurred, frame.number, input_.several_frames);
      if (const Status ok = savePicture(toImage(picture_), file); !ok) {
        return ok.error();
      }
      json["file"] = file;
    }
    if (!options_.compare.empty()) {
      const Result<Json> compared = compare(frame, line);
      if (!compared) {
        return compared.error();
      }
      json["compare"] = *compared;
    }
    lines_.push_back(line);
    return Json{{"lens", json}};
  }

  void print() const override {
    for (const std::string& line : lines_) {
      fmt::print("{}\n", line);
    }
  }

 private:
  // Sets the motion to the next frame. The last frame uses the one before, which gives the same line of
  // motion.
  void setMotion(const SortedFrame& frame) {
    const Walk& walk = input_.input.walk;
    settings_.motion.reset();
    const std::optional<std::uint32_t> other = motionFrame(walk, frame.number);
    if (options_.motion_blur == 0.0 || !other) {
      return;
    }
    placements(input_.input.moving, *other, other_stored_);
    View later = walk.view(*other, input_.input.moving.scene);
    later.aspect = frame.view.aspect;
    settings_.motion =
        FrameMotion{.later = later, .later_stored = other_stored_, .shutter = options_.motion_blur};
  }

  Json statsJson(const LensStats& stats) const {
    Json json = {{"method", methodName(options_)},      {"focus", settings_.lens.focus},
                 {"aperture", settings_.lens.aperture}, {"passes", settings_.passes},
                 {"motion_blur", options_.motion_blur}, {"render_passes", stats.render_passes},
                 {"triangles", stats.triangles}};
    if (settings_.method == LensMethod::kLayers) {
      json["layers"] = {{"drawn", stats.layers},
                        {"even", stats.even},
                        {"depth", stats.by_depth},
                        {"accumulate", stats.accumulated},
                        {"moved", stats.moved}};
    }
    return json;
  }

  // Compares the picture with the reference and writes both and their difference side by side.
  Result<Json> compare(const SortedFrame& frame, std::string& line) {
    LensSettings reference = settings_;
    reference.method = LensMethod::kAccumulation;
    reference.passes = options_.reference_passes;
    reference.progress = [&](double done) { frame.progress(0.5 + 0.5 * done); };
    if (const Result<LensStats> drawn = lens_.draw(frame.view, frame.layers, reference, reference_); !drawn) {
      return drawn.error();
    }
    const PictureDifference difference = measureDifference(picture_, reference_, kDifferenceTolerance);
    line += fmt::format("; from {} accumulated pictures it differs by {}", reference.passes,
                        differenceText(difference));
    const std::string file = frameFile(options_.compare, frame.number, input_.several_frames);
    if (const Status ok = writeComparison(picture_, reference_, file); !ok) {
      return ok.error();
    }
    return Json{{"passes", reference.passes}, {"difference", differenceJson(difference)}, {"file", file}};
  }

  const LayerLensOptions& options_;
  const FrameMakerInput& input_;
  LayerRenderer renderer_;
  LensPicture lens_;
  LensSettings settings_;
  LayerImage picture_, reference_;
  std::vector<Mat4> other_stored_;  // transforms of the parts in the frame to which they move
  std::vector<std::string> lines_;
};

Result<PartBlur> readPartBlur(const std::string& text, std::size_t parts) {
  const std::vector<std::string> words = splitAt(text, '=');
  const std::vector<std::string> names = textsOf(kLayerBlurs);
  const std::optional<std::uint32_t> part = parseWhole(words.front());
  if (!part || words.size() != 2 || std::find(names.begin(), names.end(), words.back()) == names.end()) {
    return Error{fmt::format("--blur-layer {}: is not PART=even, PART=depth or PART=accumulate", text)};
  }
  if (*part >= parts) {
    return Error{fmt::format("--blur-layer {}: there is no such part; the scene has {}, numbered from 0",
                             text, parts)};
  }
  return PartBlur{PartId(*part), valueOf(kLayerBlurs, words.back())};
}

Status checkNumbers(const LayerLensOptions& options) {
  const bool has_lens = !options.depth_of_field.empty();
  if (has_lens && !(options.focus > 0.0 && std::isfinite(options.focus))) {
    return Error{fmt::format("--focus {}: must be more than 0 metres", options.focus)};
  }
  if (has_lens && !(options.aperture >= 0.0 && std::isfinite(options.aperture))) {
    return Error{fmt::format("--aperture {}: must be 0 metres or more", options.aperture)};
  }
  if (!(options.motion_blur >= 0.0 && options.motion_blur <= 1.0)) {
    return Error{fmt::format("--motion-blur {}: must be 0 to 1 of a frame", options.motion_blur)};
  }
  for (const auto& [option, passes] :
       {std::pair("--passes", options.passes), {"--reference-passes", options.reference_passes}}) {
    if (passes < 1 || passes > kMaxPasses) {
      return Error{fmt::format("{} {}: must be 1 to {}", option, passes, kMaxPasses)};
    }
  }
  const LensMethod method = valueOf(kLensMethods, methodName(options));
  const bool by_layers = method == LensMethod::kLayers;
  if (options.motion_blur > 0.0 && !by_layers && method != LensMethod::kAccumulation) {
    return Error{
        fmt::format("--motion-blur: not with --depth-of-field {}, which blurs one picture of "
                    "everything; take layers or accumulation",
                    options.depth_of_field)};
  }
  if (!options.blur_layer.empty() && !by_layers) {
    return Error{"--blur-layer: goes with --depth-of-field layers"};
  }
  if (options.passes != LayerLensOptions{}.passes && !by_layers && method != LensMethod::kAccumulation) {
    return Error{fmt::format("--passes: --depth-of-field {} accumulates nothing; leave it out",
                             options.depth_of_field)};
  }
  if (options.reference_passes != LayerLensOptions{}.reference_passes && options.compare.empty()) {
    return Error{"--reference-passes: goes with --compare"};
  }
  return Success{};
}

Result<LensSettings> settingsOf(const LayerLensOptions& options, const FrameMakerInput& input) {
  if (const Status ok = checkNumbers(options); !ok) {
    return ok.error();
  }
  LensSettings settings;
  settings.method = valueOf(kLensMethods, methodName(options));
  settings.lens.aperture = 0.0;
  if (!options.depth_of_field.empty()) {
    settings.lens = {.focus = options.focus, .aperture = options.aperture};
  }
  settings.passes = options.passes;
  settings.form = input.form;
  for (const std::string& text : options.blur_layer) {
    const Result<PartBlur> part = readPartBlur(text, input.input.moving.parts.size());
    if (!part) {
      return part.error();
    }
    const auto is_same = [&](const PartBlur& other) { return other.part == part->part; };
    if (std::any_of(settings.parts.begin(), settings.parts.end(), is_same)) {
      return Error{fmt::format("--blur-layer {}: the part is named twice", text)};
    }
    settings.parts.push_back(*part);
  }
  return settings;
}

}  // namespace

std::optional<std::uint32_t> motionFrame(const Walk& walk, std::uint32_t frame) {
  const std::size_t frames = walk.path.frames.size();
  if (frames < 2) {
    return std::nullopt;
  }
  return frame + 1 < frames ? frame + 1 : frame - 1;
}

void addLayerLensOptions(CLI::App& command, LayerLensOptions& options) {
  CLI::Option* focus = command.add_option("--focus", options.focus, "metres to what is sharp");
  CLI::Option* aperture = command.add_option("--aperture", options.aperture, "the lens's diameter, metres");
  CLI::Option* depth_of_field =
      command
          .add_option("--depth-of-field", options.depth_of_field,
                      "blur what is out of focus: each layer by itself, one picture of everything (potmesil: "
                      "normalised; rokita: as it arrives), or by accumulating pictures from points of the "
                      "lens")
          ->check(isOneOf(textsOf(kLensMethods)))
          ->needs(focus, aperture);
  focus->needs(depth_of_field);
  aperture->needs(depth_of_field);
  command.add_option("--motion-blur", options.motion_blur,
                     "blur what moves, by layers or accumulation: how much of a frame's time the shutter is "
                     "open, 0 to 1");
  command.add_option("--passes", options.passes, "pictures that each accumulation takes")
      ->capture_default_str();
  command.add_option("--blur-layer", options.blur_layer,
                     "PART=even|depth|accumulate: how the layer of this part is blurred (else chosen by its "
                     "depth)");
  command
      .add_option("--blurred", options.blurred, "write the blurred picture of each frame to this .png file")
      ->type_name(kFileType)
      ->check(isNotEmpty());
  command
      .add_option("--compare", options.compare,
                  "write the blurred picture, beside it the accumulation of whole pictures, and where they "
                  "differ, to this .png file")
      ->type_name(kFileType)
      ->check(isNotEmpty());
  command
      .add_option("--reference-passes", options.reference_passes,
                  "pictures that the accumulation of --compare takes")
      ->capture_default_str();
}

Result<std::unique_ptr<FrameMaker>> makeLayerLens(const LayerLensOptions& options,
                                                  const FrameMakerInput& input) {
  if (options.depth_of_field.empty() && options.motion_blur == 0.0) {
    if (options != LayerLensOptions{}) {
      return Error{
          "--blurred, --compare, --blur-layer, --passes and --reference-passes: go with --depth-of-field or "
          "--motion-blur"};
    }
    return std::unique_ptr<FrameMaker>();
  }
  Result<LensSettings> settings = settingsOf(options, input);
  if (!settings) {
    return settings.error();
  }
  if (options.blurred.empty() && options.compare.empty()) {
    return Error{"--depth-of-field and --motion-blur: name a file with --blurred or --compare"};
  }
  Result<LayerRenderer> renderer = makeRenderer(input);
  if (!renderer) {
    return renderer.error();
  }
  return std::unique_ptr<FrameMaker>(
      std::make_unique<LayerLens>(options, input, std::move(*renderer), std::move(*settings)));
}

}  // namespace sightline::tool
