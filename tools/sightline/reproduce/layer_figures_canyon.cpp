// Figure 23 of Snyder and Lengyel 1997, and the effect of reusing layers' images on a picture of the canyon.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sightline/render/layer_compositor.h"
#include "sightline/render/layer_reuse.h"
#include "tools/sightline/reproduce/layer_figure_scene.h"
#include "tools/sightline/reproduce/snyder_lengyel.h"

namespace sightline::tool {
namespace {

constexpr double kAspect = 16.0 / 9.0;
constexpr std::uint32_t kGrid = 14;
constexpr std::uint32_t kScoutHeight =
    72;                                  // height in pixels of pictures in which the best frame is searched
constexpr std::uint32_t kGuard = 24;     // guard band of reused images, in pixels
constexpr double kReuseTolerance = 1.0;  // pixels

// A piece of terrain that is in a cycle of occlusions with a part of an aircraft.
struct Highlight {
  std::uint32_t frame = 0;
  PartId piece, ship;
  std::uint64_t pixels = 0;  // pixels of a small picture that show the piece
};

std::vector<ObjectId> objectsOf(const MovingScene& scene) {
  std::vector<ObjectId> objects;
  for (std::size_t part = 0; part < scene.parts.size(); ++part) {
    objects.emplace_back(part);
  }
  return objects;
}

// Searches all frames for the piece that most pixels show.
class HighlightSearch {
 public:
  HighlightSearch(const MovingScene& scene, LayerRenderer& renderer)
      : scene_(scene), renderer_(renderer), everything_(objectsOf(scene)) {}

  std::optional<Highlight> find() {
    LayerSorter sorter = makeSorter(scene_, canyonSorting());
    std::vector<Mat4> poses;
    for (std::uint32_t frame = 0; frame < scene_.frames; ++frame) {
      View view = scene_.scene.paths.front().view(frame, scene_.scene.origin);
      view.aspect = kAspect;
      pose(scene_, frame, poses, sorter);
      const LayerOrder& order = sorter.update(view);
      for (std::size_t group = 0; group < order.groups(); ++group) {
        look(frame, view, order.group(group));
      }
    }
    return best_;
  }

 private:
  bool isOfClass(PartId part, const char* name) const {
    return scene_.classes[scene_.parts[part.value].class_of] == name;
  }

  void look(std::uint32_t frame, const View& view, std::span<const PartId> group) {
    const auto ship =
        std::find_if(group.begin(), group.end(), [&](PartId part) { return isOfClass(part, "aircraft"); });
    if (ship == group.end()) {
      return;
    }
    for (const PartId part : group) {
      if (!isOfClass(part, "terrain")) {
        continue;
      }
      const std::uint64_t pixels = pixelsOf(frame, view, part);
      if (pixels > (best_ ? best_->pixels : 0)) {
        best_ = Highlight{frame, part, *ship, pixels};
      }
    }
  }

  // The pixels in which the part is nearest, alone or together with others that overlap it.
  std::uint64_t pixelsOf(std::uint32_t frame, const View& view, PartId part) {
    if (drawn_frame_ != frame) {
      placements(scene_, frame, scene_from_stored_);
      renderer_.setTransforms(scene_from_stored_);
      renderer_.draw(view, everything_, {.depths = true}, all_);
      drawn_frame_ = frame;
    }
    const ObjectId object(part.value);
    renderer_.draw(view, {&object, 1}, {.depths = true}, alone_);
    std::uint64_t pixels = 0;
    for (std::size_t i = 0; i < alone_.depths.size(); ++i) {
      pixels += alone_.depths[i] != LayerImage::kNoDepth && alone_.depths[i] <= all_.depths[i] ? 1 : 0;
    }
    return pixels;
  }

  const MovingScene& scene_;
  LayerRenderer& renderer_;
  std::vector<ObjectId> everything_;
  std::vector<Mat4> scene_from_stored_;
  std::optional<std::uint32_t> drawn_frame_;
  LayerImage all_, alone_;
  std::optional<Highlight> best_;
};

// The canyon with a piece to highlight: with the paper's grid or, if that has none, the next coarser one that
// does.
struct HighlightedCanyon {
  std::uint32_t grid = kGrid;
  MovingScene scene;
  std::optional<Highlight> highlight;
};

Result<HighlightedCanyon> findHighlight() {
  for (const std::uint32_t grid : {kGrid, 10u, 7u, 5u}) {
    HighlightedCanyon canyon{grid, makeCanyon({.grid = grid}), {}};
    Result<LayerRenderer> scout =
        figureRenderer(canyon.scene.scene, {.height = kScoutHeight, .samples = 1}, kAspect);
    if (!scout) {
      return scout.error();
    }
    canyon.highlight = HighlightSearch(canyon.scene, *scout).find();
    if (canyon.highlight) {
      return canyon;
    }
  }
  return HighlightedCanyon{kGrid, makeCanyon({.grid = kGrid}), {}};
}

// Colours the piece and returns the text about it.
std::string paint(HighlightedCanyon& canyon) {
  if (!canyon.highlight) {
    return "composited from layers; no piece of terrain is in a cycle with an aircraft in any frame";
  }
  MovingScene& scene = canyon.scene;
  const Highlight& found = *canyon.highlight;
  scene.scene.objects[found.piece.value].material = MaterialId(scene.scene.materials.size());
  scene.scene.materials.push_back({.name = "highlight", .base_color = {0.85f, 0.12f, 0.05f, 1.0f}});
  return fmt::format("composited from layers; highlighted: {}, in a cycle of occlusions with {}",
                     scene.parts[found.piece.value].name, scene.parts[found.ship.value].name);
}

// Draws the canyon from layers and, if at_once is given, all objects at once by a depth buffer.
Status drawCanyon(const MovingScene& scene, std::uint32_t number, const LayerFigureOptions& options,
                  LayerImage& picture, LayerImage* at_once) {
  Result<LayerRenderer> renderer = figureRenderer(scene.scene, options, kAspect);
  if (!renderer) {
    return renderer.error();
  }
  const FigureFrame frame = sortedFrame(scene, canyonSorting(), number, kAspect);
  renderer->setTransforms(frame.scene_from_stored);
  LayerCompositor compositor(scene.scene.view(), *renderer);
  const Result<CompositeStats> stats =
      compositor.composite(frame.view, frame.layers, {.peel = CompositeSettings::Peel::kNever}, picture);
  if (stats && at_once != nullptr) {
    renderer->draw(frame.view, objectsOf(scene), {}, *at_once);
  }
  return stats ? Status(Success{}) : stats.error();
}

// The frame with the paper's grid, beside a coarser one that has a piece to highlight.
Status addPapersGrid(std::uint32_t number, const LayerFigureOptions& options, FigurePictures& pictures) {
  LayerImage picture;
  if (const Status ok = drawCanyon(makeCanyon({.grid = kGrid}), number, options, picture, nullptr); !ok) {
    return ok;
  }
  pictures.add("figure23_papers_grid",
               fmt::format("{0} x {0}, as in the paper: composited from layers; here no frame has a piece of "
                           "terrain in a cycle with an aircraft",
                           kGrid),
               picture);
  return Success{};
}

Finding findingOf(const HighlightedCanyon& canyon, const PictureDifference& difference) {
  const bool found = canyon.highlight.has_value();
  return {
      "figure 23: with 14 x 14 a piece of terrain is in a cycle of occlusions with the ship above it, and "
      "the layers' picture is right nonetheless",
      found && canyon.grid == kGrid && difference.mean < 1.0,
      fmt::format("{}. The picture from layers differs from that by depth buffer by {:.4f} of 255 in the "
                  "mean. Where cycles begin depends on how low the aircraft fly over which valley, which "
                  "the paper does not give",
                  !found ? "no frame has such a cycle with any grid"
                  : canyon.grid == kGrid
                      ? "so it is"
                      : fmt::format("no frame has such a cycle with {0} x {0}, frame {1} has one with {2} "
                                    "x {2}",
                                    kGrid, canyon.highlight->frame, canyon.grid),
                  difference.mean)};
}

Status figure23(const LayerFigureOptions& options, LayerFigures& figures) {
  Result<HighlightedCanyon> canyon = findHighlight();
  if (!canyon) {
    return canyon.error();
  }
  const std::uint32_t number = canyon->highlight ? canyon->highlight->frame : 0;
  // The pictures are compared before the piece is coloured, because chance decides which of two overlapping
  // pieces shows.
  LayerImage plain, at_once, highlighted;
  if (const Status ok = drawCanyon(canyon->scene, number, options, plain, &at_once); !ok) {
    return ok;
  }
  const std::string caption = paint(*canyon);
  if (const Status ok = drawCanyon(canyon->scene, number, options, highlighted, nullptr); !ok) {
    return ok;
  }
  FigurePictures pictures(23, fmt::format("Figure 23: the canyon from layers (frame {})", number), figures);
  const std::string split = fmt::format("{0} x {0}: ", canyon->grid);
  pictures.add("figure23_canyon", split + caption, highlighted);
  pictures.add("figure23_zbuffer", split + "all objects at once, by depth buffer, without the highlight",
               at_once);
  const PictureDifference difference = pictures.addDifference(
      "figure23_difference", split + "what layers differ from that:", plain, at_once, 4);
  figures.findings.push_back(findingOf(*canyon, difference));
  return canyon->grid == kGrid ? Status(Success{}) : addPapersGrid(number, options, pictures);
}

// Draws frames both in full and with reused images of layers; keeps the last frame's two pictures.
class ReusedFrames {
 public:
  ReusedFrames(const MovingScene& scene, LayerRenderer& plain, LayerRenderer& guarded)
      : scene_(scene),
        plain_(plain),
        compositor_(scene.scene.view(), plain),
        reuse_(scene.scene.view(), guarded, {.tolerance_px = kReuseTolerance, .guard_px = kGuard}) {}

  // Draws this number of frames.
  Status run(std::uint32_t frames) {
    LayerSorter sorter = makeSorter(scene_, canyonSorting());
    LayerMerger merger;
    std::vector<Mat4> poses, scene_from_stored;
    for (std::uint32_t frame = 0; frame < frames; ++frame) {
      View view = scene_.scene.paths.front().view(frame, scene_.scene.origin);
      view.aspect = kAspect;
      pose(scene_, frame, poses, sorter);
      const FrameLayers& layers = merger.merge(sorter.update(view));
      placements(scene_, frame, scene_from_stored);
      before_ = reuse_.stats();
      reuse_.beginFrame(view, scene_from_stored);
      CompositeSettings settings{.peel = CompositeSettings::Peel::kNever};
      settings.draw_layer = [&](std::span<const ObjectId> objects, const LayerDraw& how, LayerImage& image) {
        reuse_.image(objects, how, image);
      };
      if (const Result<CompositeStats> ok = compositor_.composite(view, layers, settings, reused); !ok) {
        return ok.error();
      }
      if (frame + 1 == frames) {
        plain_.setTransforms(scene_from_stored);
        settings.draw_layer = {};
        if (const Result<CompositeStats> ok = compositor_.composite(view, layers, settings, anew); !ok) {
          return ok.error();
        }
      }
    }
    return Success{};
  }

  std::uint64_t layers() const { return reuse_.stats().layers - before_.layers; }  // in the last frame
  std::uint64_t drawn() const { return reuse_.stats().drawn - before_.drawn; }

  LayerImage anew, reused;

 private:
  const MovingScene& scene_;
  LayerRenderer& plain_;
  LayerCompositor compositor_;
  LayerReuse reuse_;
  ReuseStats before_;
};

Status savedRenderingFigure(const LayerFigureOptions& options, LayerFigures& figures) {
  const MovingScene scene = makeCanyon({.grid = kGrid});
  Result<LayerRenderer> plain = figureRenderer(scene.scene, options, kAspect);
  if (!plain) {
    return plain.error();
  }
  Result<LayerRenderer> guarded =
      LayerRenderer::create(scene.scene.view(), {.width = plain->width() + 2 * kGuard,
                                                 .height = plain->height() + 2 * kGuard,
                                                 .samples = options.samples,
                                                 .tints = false});
  if (!guarded) {
    return guarded.error();
  }
  ReusedFrames run(scene, *plain, *guarded);
  if (const Status ok = run.run(options.reused_frames); !ok) {
    return ok;
  }
  FigurePictures pictures(
      24,
      fmt::format("Saved rendering: the canyon, {0} x {0}, after {1} frames", kGrid, options.reused_frames),
      figures);
  pictures.add("saved_anew", fmt::format("all {} visible layers drawn", run.layers()), run.anew);
  pictures.add(
      "saved_reused",
      fmt::format("{} drawn anew in this frame, {} warped from earlier ones, by up to {:.0f} pixel wrong",
                  run.drawn(), run.layers() - run.drawn(), kReuseTolerance),
      run.reused);
  pictures.addDifference("saved_difference", "their difference:", run.reused, run.anew);
  return Success{};
}

}  // namespace

Status canyonFigures(const LayerFigureOptions& options, LayerFigures& figures) {
  if (const Status ok = figure23(options, figures); !ok) {
    return ok;
  }
  return savedRenderingFigure(options, figures);
}

}  // namespace sightline::tool
