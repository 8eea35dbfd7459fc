// Based on: Snyder, Lengyel. Visibility Sorting and Compositing for Image-Based Rendering. MSR-TR-97-11,
// 1997, sections 10 to 12.

#include "tools/sightline/reproduce/layer_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "sightline/drawing/drawing.h"
#include "sightline/render/lens_picture.h"
#include "src/base/stopwatch.h"
#include "tools/sightline/command_line/progress_bar.h"
#include "tools/sightline/reproduce/layer_figure_scene.h"

namespace sightline::tool {
namespace {

constexpr std::uint32_t kToothpickFrame = 100;
constexpr double kNarrower = 0.83;  // narrows the walk's view so that the cube fills the picture
constexpr const char* kHeading17 = "Figure 17: toothpicks, drawn with hidden line elimination";

// ---- Figure 16: something near and blurred before something that is in focus.

constexpr double kFigure16Aspect = 4.0 / 3.0;
constexpr Lens kFigure16Lens{.focus = 8.0, .aperture = 0.2};

// Appends an object of these corners and triangles, with its hull.
void addObject(MovingScene& scene, const std::string& name, const std::array<float, 4>& color,
               const std::vector<Vec3f>& corners, const std::vector<std::uint32_t>& triangles) {
  Scene& to = scene.scene;
  Object object;
  object.first_index = static_cast<std::uint32_t>(to.indices.size());
  object.index_count = static_cast<std::uint32_t>(triangles.size());
  object.material = MaterialId(to.materials.size());
  const auto first = static_cast<std::uint32_t>(to.positions.size());
  for (const std::uint32_t corner : triangles) {
    to.indices.push_back(first + corner);
  }
  to.positions.insert(to.positions.end(), corners.begin(), corners.end());
  to.materials.push_back({.name = name, .double_sided = true, .base_color = color});
  to.objects.push_back(object);
  to.object_names.push_back(name);
  std::vector<Vec3d> points;
  for (const Vec3f& corner : corners) {
    points.emplace_back(corner);
  }
  scene.parts.push_back({.name = name, .hulls = {static_cast<std::uint32_t>(scene.hulls.size())}});
  scene.hulls.push_back(*buildHull(points));
}

// Adds pyramids side by side, on which focus can be seen.
void addBoard(MovingScene& scene) {
  constexpr int kColumns = 16, kRows = 12;
  constexpr int kMiddleColumn = kColumns / 2, kMiddleRow = kRows / 2;
  constexpr float kSide = 0.45f, kRise = 0.2f, kDepth = -8.0f;
  std::vector<Vec3f> corners;
  std::vector<std::uint32_t> triangles;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const auto first = static_cast<std::uint32_t>(corners.size());
      const float x = kSide * static_cast<float>(column - kMiddleColumn);
      const float y = kSide * static_cast<float>(row - kMiddleRow);
      corners.insert(corners.end(), {{x, y, kDepth},
                                     {x + kSide, y, kDepth},
                                     {x + kSide, y + kSide, kDepth},
                                     {x, y + kSide, kDepth},
                                     {x + 0.5f * kSide, y + 0.5f * kSide, kDepth + kRise}});
      for (std::uint32_t side = 0; side < 4; ++side) {
        triangles.insert(triangles.end(), {first + side, first + (side + 1) % 4, first + 4});
      }
    }
  }
  addObject(scene, "board", {0.35f, 0.5f, 0.62f, 1.0f}, corners, triangles);
}

// Adds a slanting bar before the board. It is flat, so its circle of confusion is the same everywhere.
void addBar(MovingScene& scene) {
  addObject(scene, "bar", {0.75f, 0.22f, 0.08f, 1.0f},
            {{-0.75f, -0.62f, -2.0f}, {-0.4f, -0.72f, -2.0f}, {0.75f, 0.62f, -2.0f}, {0.4f, 0.72f, -2.0f}},
            {0, 1, 2, 0, 2, 3});
}

MovingScene makeBarBeforeBoard() {
  MovingScene scene;
  addBoard(scene);
  addBar(scene);
  updateBounds(scene.scene);
  CameraPath path;
  path.name = "still";
  path.fovy_deg = 45.0;
  path.frames = {{{0.0, 0.0, 0.0}, {0.0, 0.0, -1.0}, {0.0, 1.0, 0.0}}};
  scene.scene.paths = {path};
  scene.frames = 1;
  return scene;
}

// ---- Both figures of depth of field.

Experiment depthOfFieldTable() {
  return {"depth_of_field",
          "Figures 16 and 22: depth of field beside the accumulation of whole pictures (difference: of 255)",
          "single pictures go wrong where a blurred edge shows what it hides; layers do not",
          {{"figure", "figure", 0},
           {"method", "method"},
           {"images", "images drawn", 0},
           {"difference", "difference", 3},
           {"largest", "largest", 0},
           {"beyond", "pixels > 4 %", 2},
           {"ms", "ms", 1}}};
}

// Draws one frame with several methods, beside a reference.
class LensFigure {
 public:
  LensFigure(std::uint32_t figure, const FigureFrame& frame, LensPicture& lens, Experiment& table,
             FigurePictures& pictures)
      : figure_(figure), frame_(frame), lens_(lens), table_(table), pictures_(pictures) {}

  Status reference(const std::string& file, const std::string& name, LensSettings settings) {
    settings.method = LensMethod::kAccumulation;
    return draw(file, name, settings, reference_);
  }

  // Adds the method's picture and the picture of where it differs from the reference.
  Status method(const std::string& file, const std::string& name, const LensSettings& settings) {
    if (const Status ok = draw(file, name, settings, picture_); !ok) {
      return ok;
    }
    const PictureDifference difference = pictures_.addDifference(
        file + "_difference", "its difference from the reference:", picture_, reference_);
    Json& row = table_.rows.back();
    row["difference"] = difference.mean;
    row["largest"] = difference.largest;
    row["beyond"] = 100.0 * difference.share_beyond;
    return Success{};
  }

 private:
  Status draw(const std::string& file, const std::string& name, const LensSettings& settings,
              LayerImage& picture) {
    base::Stopwatch watch;
    const Result<LensStats> stats = lens_.draw(frame_.view, frame_.layers, settings, picture);
    if (!stats) {
      return stats.error();
    }
    table_.rows.push_back({{"figure", figure_},
                           {"method", name},
                           {"images", stats->render_passes},
                           {"ms", 1e-3 * watch.lap()}});
    pictures_.add(file, name, picture);
    return Success{};
  }

  std::uint32_t figure_;
  const FigureFrame& frame_;
  LensPicture& lens_;
  Experiment& table_;
  FigurePictures& pictures_;
  LayerImage picture_, reference_;
};

Status figure16(const LayerFigureOptions& options, Experiment& table, LayerFigures& figures) {
  const MovingScene scene = makeBarBeforeBoard();
  const FigureFrame frame = sortedFrame(scene, {}, 0, kFigure16Aspect);
  Result<LayerRenderer> renderer = figureRenderer(scene.scene, options, kFigure16Aspect);
  if (!renderer) {
    return renderer.error();
  }
  LensPicture lens(scene.scene.view(), *renderer);
  FigurePictures pictures(
      16, "Figure 16: depth of field by blurring images, a near bar before a board in focus", figures);
  LensFigure figure(16, frame, lens, table, pictures);
  const std::uint32_t passes = 4 * options.passes;
  LensSettings settings{.lens = kFigure16Lens, .passes = passes, .peel = CompositeSettings::Peel::kNever};
  if (const Status ok = figure.reference("figure16_accumulation",
                                         fmt::format("reference: {} accumulated pictures", passes), settings);
      !ok) {
    return ok;
  }
  struct Way {
    LensMethod method;
    const char *file, *name;
  };
  for (const Way& way : {Way{LensMethod::kSingleNormalised, "figure16_potmesil",
                             "(a) one picture, normalised (Potmesil): the bar's edge stays sharp"},
                         Way{LensMethod::kSingleUnnormalised, "figure16_rokita",
                             "(b) one picture, as it arrives (Rokita): dark where nothing arrives"},
                         Way{LensMethod::kLayers, "figure16_layers", "(c) two layers, composited"}}) {
    settings.method = way.method;
    if (const Status ok = figure.method(way.file, way.name, settings); !ok) {
      return ok;
    }
  }
  return Success{};
}

// ---- Figure 22.

// Focused on the middle of the cube; the farthest and the nearest corners are blurred most.
constexpr Lens kFigure22Lens{.focus = 2.9, .aperture = 0.12};

// Gives each layer of several parts a colour of its own; all other parts become white.
void colorByLayers(const FrameLayers& layers, Scene& scene) {
  constexpr std::array<std::array<float, 4>, 6> kColors{{{0.85f, 0.1f, 0.08f, 1.0f},
                                                         {0.1f, 0.45f, 0.9f, 1.0f},
                                                         {0.1f, 0.6f, 0.15f, 1.0f},
                                                         {0.95f, 0.6f, 0.05f, 1.0f},
                                                         {0.55f, 0.2f, 0.75f, 1.0f},
                                                         {0.05f, 0.65f, 0.65f, 1.0f}}};
  scene.materials = {{.name = "single", .base_color = {0.95f, 0.95f, 0.95f, 1.0f}}};
  for (const std::array<float, 4>& color : kColors) {
    scene.materials.push_back({.name = "several", .base_color = color});
  }
  std::size_t next = 0;
  for (std::uint32_t layer = 0; layer < layers.layers(); ++layer) {
    const std::span<const PartId> parts = layers.partsOf(LayerId(layer));
    const MaterialId material(parts.size() > 1 ? 1 + next++ % kColors.size() : 0);
    for (const PartId part : parts) {
      scene.objects[part.value].material = material;
    }
  }
}

// Chooses one blur for each layer; the cube's long edges, which reach through all depths, are accumulated.
std::vector<PartBlur> figure22Blurs(const MovingScene& scene) {
  std::vector<PartBlur> blurs, edges;
  for (std::size_t i = 0; i < scene.parts.size(); ++i) {
    const bool is_edge = scene.classes[scene.parts[i].class_of] == "edge";
    (is_edge ? edges : blurs).push_back({PartId(i), is_edge ? LayerBlur::kAccumulate : LayerBlur::kEven});
  }
  blurs.insert(blurs.end(), edges.begin(), edges.end());  // the last entry for a layer counts
  return blurs;
}

Status figure22(const LayerFigureOptions& options, Experiment& table, LayerFigures& figures) {
  MovingScene scene = makeToothpicks({});
  FigureFrame frame = sortedFrame(scene, {}, kToothpickFrame, 1.0);
  frame.view.tan_half_fovy *= kNarrower;
  colorByLayers(frame.layers, scene.scene);
  Result<LayerRenderer> renderer = figureRenderer(scene.scene, options, 1.0);
  if (!renderer) {
    return renderer.error();
  }
  renderer->setTransforms(frame.scene_from_stored);
  LensPicture lens(scene.scene.view(), *renderer);
  FigurePictures pictures(22,
                          "Figure 22: depth of field of toothpicks; those of a layer of several share a "
                          "colour, all others are white",
                          figures);
  LensFigure figure(22, frame, lens, table, pictures);
  LensSettings settings{
      .lens = kFigure22Lens, .passes = options.passes, .peel = CompositeSettings::Peel::kNever};
  if (const Status ok =
          figure.reference("figure22_accumulation",
                           fmt::format("(a) accumulation buffer, {} pictures", options.passes), settings);
      !ok) {
    return ok;
  }
  settings.parts = figure22Blurs(scene);
  return figure.method("figure22_layers", "(b) visibility compositing", settings);
}

// ---- Figure 17.

Status figure17Shaded(const LayerFigureOptions& options, LayerFigures& figures) {
  const MovingScene scene = makeToothpicks({.count = options.toothpicks});
  FigureFrame frame = sortedFrame(scene, {}, kToothpickFrame, 1.0);
  frame.view.tan_half_fovy *= kNarrower;
  Result<LayerRenderer> renderer = figureRenderer(scene.scene, options, 1.0);
  if (!renderer) {
    return renderer.error();
  }
  renderer->setTransforms(frame.scene_from_stored);
  LayerCompositor compositor(scene.scene.view(), *renderer);
  LayerImage picture;
  const Result<CompositeStats> stats =
      compositor.composite(frame.view, frame.layers, {.peel = CompositeSettings::Peel::kNever}, picture);
  if (!stats) {
    return stats.error();
  }
  FigurePictures(17, kHeading17, figures)
      .add("figure17_shaded", fmt::format("the same frame, composited from {} layers", stats->layers),
           picture);
  return Success{};
}

}  // namespace

LayerFigureOptions layerFigureOptions(const ReproduceOptions& options) {
  LayerFigureOptions own;
  if (options.picture.height > 0) {
    own.height = options.picture.height;
  } else if (options.fewer_frames) {
    own = {.height = 120, .samples = 1, .passes = 5, .toothpicks = 200, .reused_frames = 3};
  }
  return own;
}

LayerFigures hiddenLineFigure(const LayerFigureOptions& options) {
  const MovingScene scene = makeToothpicks({.count = options.toothpicks});
  Scene posed;
  posedScene(scene, kToothpickFrame, posed);
  LayerSorter sorter = makeSorter(scene, {});
  std::vector<Mat4> poses;
  pose(scene, kToothpickFrame, poses, sorter);
  View view = scene.scene.paths.front().view(kToothpickFrame, scene.scene.origin);
  view.aspect = 1.0;
  view.tan_half_fovy *= kNarrower;
  const LayerOrder& order = sorter.update(view);
  HiddenLineRenderer renderer(posed.view());
  base::Stopwatch watch;
  const Drawing drawing =
      renderer.paint(posed.view(), posed.object_names, view, order, {.page_height = 800.0});
  const double draw_ms = 1e-3 * watch.lap();
  std::string svg = toSvg(drawing, {.stroke_width = 0.4, .title = "toothpicks"});
  LayerFigures figures;
  figures.experiments.push_back({"hidden_lines",
                                 "Figure 17: a frame drawn with hidden line elimination",
                                 "lines are tested against the objects of their own group alone",
                                 {{"n", "toothpicks", 0},
                                  {"lines", "lines", 0},
                                  {"strokes", "strokes", 0},
                                  {"pairs", "line-object tests", 0},
                                  {"all_pairs", "without the sort", 0},
                                  {"bytes", "SVG bytes", 0},
                                  {"ms", "ms", 1}},
                                 {{{"n", options.toothpicks},
                                   {"lines", drawing.stats.lines},
                                   {"strokes", countStrokes(drawing)},
                                   {"pairs", drawing.pairs},
                                   {"all_pairs", drawing.all_pairs},
                                   {"bytes", svg.size()},
                                   {"ms", draw_ms}}}});
  FigurePictures(17, kHeading17, figures)
      .addSvg("figure17_lines", fmt::format("{} toothpicks, as SVG", options.toothpicks), std::move(svg));
  return figures;
}

Result<LayerFigures> layerFigures(const LayerFigureOptions& options) {
  LayerFigures figures;
  Experiment table = depthOfFieldTable();
  ProgressBar progress("figures");
  if (const Status ok = figure16(options, table, figures); !ok) {
    return ok.error();
  }
  progress.update(0.2);
  if (const Status ok = figure17Shaded(options, figures); !ok) {
    return ok.error();
  }
  progress.update(0.4);
  if (const Status ok = figure22(options, table, figures); !ok) {
    return ok.error();
  }
  progress.update(0.7);
  if (const Status ok = canyonFigures(options, figures); !ok) {
    return ok.error();
  }
  figures.experiments.push_back(std::move(table));
  return figures;
}

}  // namespace sightline::tool
