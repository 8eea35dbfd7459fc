#include "tools/sightline/layers/layer_drawings.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "sightline/drawing/drawing.h"
#include "src/base/stopwatch.h"
#include "tools/sightline/command_line/output_files.h"

namespace sightline::tool {
namespace {

struct DrawingTotals {
  std::uint64_t frames = 0, lines = 0, pieces = 0, strokes = 0, tests = 0, pairs = 0, all_pairs = 0;
  std::uint64_t svg_bytes = 0, pdf_bytes = 0, largest_group = 0;
  double draw_us = 0.0;
};

std::vector<ObjectId> partsAt(const MovingScene& scene, PartSettings::Place place) {
  std::vector<ObjectId> ids;
  for (std::size_t part = 0; part < scene.parts.size(); ++part) {
    if (scene.parts[part].settings.place == place) {
      ids.emplace_back(part);
    }
  }
  return ids;
}

class LayerDrawings : public FrameMaker {
 public:
  LayerDrawings(const LayerDrawingOptions& options, const FrameMakerInput& input)
      : options_(options), input_(input) {
    settings_.features = featuresOf(options);
    settings_.page_height = static_cast<double>(input.height);
    settings_.seen_first = input.seen_first;
    settings_.overlays = partsAt(input.input.moving, PartSettings::Place::kOverlay);
    settings_.backdrops = partsAt(input.input.moving, PartSettings::Place::kBackdrop);
    style_.stroke_width = options.stroke_width;
    style_.title = std::filesystem::path(input.scene_file).filename().string();
  }

  Result<Json> make(const SortedFrame& frame) override {
    const MovingScene& moving = input_.input.moving;
    place(moving, frame.number);
    DrawingSettings settings = settings_;
    settings.progress = frame.progress;
    const std::vector<std::string>& names = moving.scene.object_names;
    base::Stopwatch watch;
    const Drawing drawing = options_.plot
                                ? renderer_->plot(posed_.view(), names, frame.view, frame.order, settings)
                                : renderer_->paint(posed_.view(), names, frame.view, frame.order, settings);
    Json json = count(drawing, watch.lap());
    if (const Status ok = write(drawing, frame.number, json); !ok) {
      return ok.error();
    }
    return Json{{"drawing", json}};
  }

  void print() const override {
    const auto mean = [&](std::uint64_t sum) {
      return static_cast<double>(sum) / static_cast<double>(std::max<std::uint64_t>(totals_.frames, 1));
    };
    const auto line = [](const char* what, double value) { fmt::print("  {:<38}{:12.1f}\n", what, value); };
    fmt::print("drawings ({}), means of a frame:\n", options_.plot ? "visible pieces" : "painter's form");
    if (!options_.plot) {
      line("objects of the largest group", mean(totals_.largest_group));
    }
    line("lines", mean(totals_.lines));
    line("visible pieces of them", mean(totals_.pieces));
    line("strokes", mean(totals_.strokes));
    line("tests of a line and a triangle", mean(totals_.tests));
    line("tests of a line and an object, asked", mean(totals_.pairs));
    line("the same without the sort", mean(totals_.all_pairs));
    line("saved by the sort, %", 100.0 * saved(totals_.pairs, totals_.all_pairs));
    if (!options_.svg.empty()) {
      line("SVG, bytes", mean(totals_.svg_bytes));
    }
    if (!options_.pdf.empty()) {
      line("PDF, bytes", mean(totals_.pdf_bytes));
    }
    line("drawing time, us", totals_.draw_us / std::max(1.0, static_cast<double>(totals_.frames)));
  }

 private:
  // The renderer is made once, since all frames of a scene have the same indices.
  void place(const MovingScene& moving, std::uint32_t frame) {
    if (!renderer_ || moving.pose) {
      posedScene(moving, frame, posed_);
    }
    if (!renderer_) {
      renderer_.emplace(posed_.view());
    }
  }

  static double saved(std::uint64_t pairs, std::uint64_t all) {
    return all == 0 ? 0.0 : 1.0 - static_cast<double>(pairs) / static_cast<double>(all);
  }

  Json count(const Drawing& drawing, double draw_us) {
    const std::uint64_t strokes = countStrokes(drawing);
    ++totals_.frames;
    totals_.lines += drawing.stats.lines;
    totals_.pieces += drawing.stats.pieces;
    totals_.strokes += strokes;
    totals_.tests += drawing.stats.tests;
    totals_.pairs += drawing.pairs;
    totals_.all_pairs += drawing.all_pairs;
    totals_.largest_group += drawing.largest_group;
    totals_.draw_us += draw_us;
    return {{"form", options_.plot ? "plot" : "painter"},
            {"lines", drawing.stats.lines},
            {"pieces", drawing.stats.pieces},
            {"strokes", strokes},
            {"triangle_tests", drawing.stats.tests},
            {"largest_group", drawing.largest_group},
            {"object_tests", drawing.pairs},
            {"object_tests_without_sort", drawing.all_pairs}};
  }

  Status write(const Drawing& drawing, std::uint32_t frame, Json& json) {
    const auto put = [&](const std::string& target, const std::string& bytes, const char* key,
                         std::uint64_t& total) -> Status {
      const std::string file = frameFile(target, frame, input_.several_frames);
      total += bytes.size();
      json[key] = file;
      json[std::string(key) + "_bytes"] = bytes.size();
      return saveFile(file, bytes);
    };
    if (!options_.svg.empty()) {
      if (Status ok = put(options_.svg, toSvg(drawing, style_), "svg", totals_.svg_bytes); !ok) {
        return ok;
      }
    }
    if (!options_.pdf.empty()) {
      return put(options_.pdf, toPdf(drawing, style_), "pdf", totals_.pdf_bytes);
    }
    return Success{};
  }

  LayerDrawingOptions options_;
  const FrameMakerInput& input_;
  std::optional<HiddenLineRenderer> renderer_;
  DrawingSettings settings_;
  DrawingStyle style_;
  Scene posed_;
  DrawingTotals totals_;
};

}  // namespace

void addLayerDrawingOptions(CLI::App& command, LayerDrawingOptions& options) {
  command
      .add_option("--svg", options.svg,
                  "write a hidden-line drawing of each frame, objects as named groups, to this .svg file")
      ->type_name(kFileType)
      ->check(isNotEmpty());
  command.add_option("--pdf", options.pdf, "the same as a .pdf file, objects as layers")
      ->type_name(kFileType)
      ->check(isNotEmpty());
  command
      .add_option(
          "--line-picture", options.line_picture,
          "the same lines in pixels, hidden by a depth buffer, to this .png file: to compare drawings "
          "with")
      ->type_name(kFileType)
      ->check(isNotEmpty());
  command.add_flag("--plot", options.plot,
                   "draw the visible pieces of lines alone, for plotters and CAD, instead of filled outlines "
                   "back to front");
  CLI::Option* crease =
      command
          .add_option("--crease", options.crease_deg,
                      "edges between two faces are drawn from this angle of their normals on, degrees")
          ->check(CLI::Range(0.0, 180.0))
          ->capture_default_str();
  command.add_flag("--no-creases", options.no_creases, "draw no edges inside of surfaces")->excludes(crease);
  command.add_flag("--no-silhouettes", options.no_silhouettes, "draw no edges at which a surface turns away");
  command.add_flag("--no-boundaries", options.no_boundaries, "draw no borders of open surfaces");
  command
      .add_option("--stroke-width", options.stroke_width,
                  "width of lines in drawings; the page is as high as --height says, in the same unit")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
}

FeatureSettings featuresOf(const LayerDrawingOptions& options) {
  return {.creases = !options.no_creases,
          .silhouettes = !options.no_silhouettes,
          .boundaries = !options.no_boundaries,
          .crease_deg = options.crease_deg};
}

Status checkLines(const LayerDrawingOptions& options) {
  // CLI::Range accepts NaN.
  if (std::isnan(options.crease_deg) || std::isnan(options.stroke_width)) {
    return Error{"--crease and --stroke-width: must be numbers"};
  }
  if (options.no_creases && options.no_silhouettes && options.no_boundaries) {
    return Error{"--no-creases --no-silhouettes --no-boundaries: no kind of line is left to draw"};
  }
  return Success{};
}

bool needAllArcs(const LayerDrawingOptions& options) {
  return options.plot;
}

Result<std::unique_ptr<FrameMaker>> makeLayerDrawings(const LayerDrawingOptions& options,
                                                      const FrameMakerInput& input) {
  const bool line_picture_alone =
      !options.line_picture.empty() && options.svg.empty() && options.pdf.empty() && !options.plot;
  if (options == LayerDrawingOptions{} || line_picture_alone) {
    return std::unique_ptr<FrameMaker>();
  }
  if (options.svg.empty() && options.pdf.empty()) {
    return Error{
        "--plot, --crease, --stroke-width and --no-...: are of drawings; say --svg FILE or --pdf FILE too"};
  }
  if (const Status ok = checkLines(options); !ok) {
    return ok.error();
  }
  return std::unique_ptr<FrameMaker>(std::make_unique<LayerDrawings>(options, input));
}

}  // namespace sightline::tool
