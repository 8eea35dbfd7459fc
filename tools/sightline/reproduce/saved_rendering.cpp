// Based on: Snyder, Lengyel. Visibility Sorting and Compositing for Image-Based Rendering. MSR-TR-97-11,
// 1997, section 12.2. Differs from the paper in: the paper assumes the share of frames in which each part is
// redrawn; here a tolerance is given and the shares are measured.
//
// Pictures have no tints: where overlapping pieces of terrain are drawn as one layer, chance decides which
// one shows.

#include "tools/sightline/reproduce/saved_rendering.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "sightline/layers/compositing.h"
#include "sightline/layers/layer_sorter.h"
#include "sightline/render/layer_compositor.h"
#include "sightline/render/layer_reuse.h"
#include "src/base/stopwatch.h"
#include "tools/sightline/command_line/progress_bar.h"
#include "tools/sightline/reproduce/snyder_lengyel.h"

namespace sightline::tool {
namespace {

constexpr std::uint32_t kShortFrames = 5, kShortHeight = 64;

// Counts of visible parts, summed over all frames.
struct PartCounts {
  double parts = 0.0, drawn_parts = 0.0;
  double triangles = 0.0, drawn_triangles = 0.0;
};

// Sums for one tolerance over all frames except the first, in which everything is drawn.
struct ReuseTotals {
  double tolerance_px = 0.0;
  ReuseStats stats;
  double images_us = 0.0;                               // time of all layers' images
  double mean = 0.0, largest_mean = 0.0, beyond = 0.0;  // PictureDifference: sums, and the largest mean
  std::vector<PartCounts> by_class;
};

struct SceneTotals {
  std::uint32_t frames = 0;
  double images_us = 0.0;  // time of drawing all layers
  std::vector<ReuseTotals> reuses;
};

ReuseStats since(const ReuseStats& now, const ReuseStats& then) {
  return {.layers = now.layers - then.layers,
          .drawn = now.drawn - then.drawn,
          .triangles = now.triangles - then.triangles,
          .drawn_triangles = now.drawn_triangles - then.drawn_triangles,
          .largest_error_px = now.largest_error_px};
}

// One way to make layers' images, with its results so far.
struct Way {
  explicit Way(double tolerance_px, std::size_t classes) {
    totals.tolerance_px = tolerance_px;
    totals.by_class.resize(classes);
  }

  std::optional<LayerReuse> reuse;
  ReuseStats at_start;  // the stats after the first frame
  LayerImage picture;
  ReuseTotals totals;
};

// Draws the frames of one scene in full and with each tolerance.
class SceneRun {
 public:
  static Result<SceneTotals> run(const MovingScene& scene, const LayerSettings& sorting,
                                 const SavedRenderingOptions& options, ProgressBar& progress);

 private:
  SceneRun(const MovingScene& scene, const SavedRenderingOptions& options, LayerRenderer plain,
           LayerRenderer guarded);
  void drawFrame(std::uint32_t frame, const LayerOrder& order, const View& view);
  void drawAll(const View& view, LayerImage& picture);
  void drawReusing(const View& view, Way& way);
  void countParts(std::span<const ObjectId> objects, bool is_drawn, Way& way) const;
  bool isInView(ObjectId object) const { return is_in_view_[object.value] != 0; }

  const MovingScene& scene_;
  LayerRenderer plain_, guarded_;
  LayerCompositor compositor_;
  std::vector<Way> ways_;
  LayerMerger merger_;
  SceneTotals totals_;

  // The current frame.
  const FrameLayers* layers_ = nullptr;
  bool is_first_ = true;
  std::vector<Mat4> world_from_part_, scene_from_stored_;
  std::vector<std::uint8_t> is_in_view_;  // one for each part
  LayerImage complete_;
};

Result<LayerRenderer> rendererOf(const MovingScene& scene, const SavedRenderingOptions& options,
                                 std::uint32_t guard_px) {
  const double aspect = scene.scene.paths.front().view(0, scene.scene.origin).aspect;
  const auto width = static_cast<std::uint32_t>(std::lround(options.height * aspect));
  return LayerRenderer::create(scene.scene.view(), {.width = width + 2 * guard_px,
                                                    .height = options.height + 2 * guard_px,
                                                    .samples = options.samples,
                                                    .tints = false});
}

Result<SceneTotals> SceneRun::run(const MovingScene& scene, const LayerSettings& sorting,
                                  const SavedRenderingOptions& options, ProgressBar& progress) {
  Result<LayerRenderer> plain = rendererOf(scene, options, 0);
  if (!plain) {
    return plain.error();
  }
  Result<LayerRenderer> guarded = rendererOf(scene, options, options.guard_px);
  if (!guarded) {
    return guarded.error();
  }
  SceneRun run(scene, options, std::move(*plain), std::move(*guarded));
  LayerSorter sorter = makeSorter(scene, sorting);
  const std::uint32_t frames = std::min(scene.frames, std::max(options.max_frames, 2u));
  for (std::uint32_t frame = 0; frame < frames; ++frame) {
    const View view = scene.scene.paths.front().view(frame, scene.scene.origin);
    pose(scene, frame, run.world_from_part_, sorter);
    run.drawFrame(frame, sorter.update(view), view);
    progress.update(static_cast<double>(frame + 1) / frames);
  }
  for (Way& way : run.ways_) {
    way.totals.stats = since(way.reuse->stats(), way.at_start);
    run.totals_.reuses.push_back(std::move(way.totals));
  }
  return std::move(run.totals_);
}

SceneRun::SceneRun(const MovingScene& scene, const SavedRenderingOptions& options, LayerRenderer plain,
                   LayerRenderer guarded)
    : scene_(scene),
      plain_(std::move(plain)),
      guarded_(std::move(guarded)),
      compositor_(scene.scene.view(), plain_) {
  for (const double tolerance_px : options.tolerances_px) {
    Way& way = ways_.emplace_back(tolerance_px, scene.classes.size());
    way.reuse.emplace(scene.scene.view(), guarded_,
                      ReuseSettings{.tolerance_px = tolerance_px, .guard_px = options.guard_px});
  }
}

void SceneRun::drawFrame(std::uint32_t frame, const LayerOrder& order, const View& view) {
  is_first_ = frame == 0;
  layers_ = &merger_.merge(order);
  const Frustum frustum = frustumOf(view);
  is_in_view_.assign(scene_.parts.size(), 0);
  for (std::size_t part = 0; part < is_in_view_.size(); ++part) {
    is_in_view_[part] = isPartInView(scene_, part, world_from_part_[part], frustum) ? 1 : 0;
  }
  placements(scene_, frame, scene_from_stored_);
  drawAll(view, complete_);
  totals_.frames += is_first_ ? 0 : 1;
  for (Way& way : ways_) {
    drawReusing(view, way);
    if (is_first_) {
      way.at_start = way.reuse->stats();
      continue;
    }
    const PictureDifference difference = measureDifference(way.picture, complete_);
    way.totals.mean += difference.mean;
    way.totals.largest_mean = std::max(way.totals.largest_mean, difference.mean);
    way.totals.beyond += difference.share_beyond;
  }
}

// Draws all layers. Layers outside the view are skipped, as with reuse.
void SceneRun::drawAll(const View& view, LayerImage& picture) {
  plain_.setTransforms(scene_from_stored_);
  CompositeSettings settings{.peel = CompositeSettings::Peel::kNever};
  settings.draw_layer = [&](std::span<const ObjectId> objects, const LayerDraw& how, LayerImage& image) {
    base::Stopwatch watch;
    if (std::any_of(objects.begin(), objects.end(), [&](ObjectId object) { return isInView(object); })) {
      plain_.draw(view, objects, how, image);
    } else {
      image.clear(plain_.width(), plain_.height());
    }
    totals_.images_us += is_first_ ? 0.0 : watch.lap();
  };
  (void)compositor_.composite(view, *layers_, settings, picture);
}

void SceneRun::drawReusing(const View& view, Way& way) {
  way.reuse->beginFrame(view, scene_from_stored_);
  CompositeSettings settings{.peel = CompositeSettings::Peel::kNever};
  settings.draw_layer = [&](std::span<const ObjectId> objects, const LayerDraw& how, LayerImage& image) {
    const std::uint64_t drawn_before = way.reuse->stats().drawn;
    base::Stopwatch watch;
    way.reuse->image(objects, how, image);
    if (!is_first_) {
      way.totals.images_us += watch.lap();
      countParts(objects, way.reuse->stats().drawn > drawn_before, way);
    }
  };
  (void)compositor_.composite(view, *layers_, settings, way.picture);
}

void SceneRun::countParts(std::span<const ObjectId> objects, bool is_drawn, Way& way) const {
  for (const ObjectId object : objects) {
    if (!isInView(object)) {
      continue;
    }
    PartCounts& counts = way.totals.by_class[scene_.parts[object.value].class_of];
    const double triangles = scene_.scene.objects[object.value].triangleCount();
    counts.parts += 1.0;
    counts.triangles += triangles;
    counts.drawn_parts += is_drawn ? 1.0 : 0.0;
    counts.drawn_triangles += is_drawn ? triangles : 0.0;
  }
}

double percent(double part, double whole) {
  return whole > 0.0 ? 100.0 * part / whole : 0.0;
}

Experiment savedTable(const SavedRenderingOptions& options) {
  return {
      "saved_rendering",
      fmt::format("Saved rendering: layers' images warped from frame to frame, pictures {} pixels high, "
                  "drawn anew after turns of {:.1f} rad (difference to the picture drawn in full: of 255)",
                  options.height, ReuseSettings{}.max_turn),
      "an image that is interpolated, or warped, need not be drawn",
      {{"scene", "scene"},
       {"tolerance", "tolerance px", 2},
       {"layers", "layers drawn %", 1},
       {"triangles", "triangles %", 1},
       {"error", "warp error px", 2},
       {"difference", "difference", 2},
       {"largest", "worst frame", 2},
       {"beyond", "pixels > 4 %", 1},
       {"all_ms", "all drawn ms", 1},
       {"reuse_ms", "reused ms", 1}}};
}

void addRows(const std::string& name, const SceneTotals& totals, Experiment& table) {
  const double frames = std::max(totals.frames, 1u);
  for (const ReuseTotals& reuse : totals.reuses) {
    const auto share = [](std::uint64_t part, std::uint64_t whole) {
      return percent(static_cast<double>(part), static_cast<double>(whole));
    };
    table.rows.push_back({{"scene", name},
                          {"tolerance", reuse.tolerance_px},
                          {"frames", totals.frames},
                          {"layers", share(reuse.stats.drawn, reuse.stats.layers)},
                          {"triangles", share(reuse.stats.drawn_triangles, reuse.stats.triangles)},
                          {"error", reuse.stats.largest_error_px},
                          {"difference", reuse.mean / frames},
                          {"largest", reuse.largest_mean},
                          {"beyond", 100.0 * reuse.beyond / frames},
                          {"all_ms", 1e-3 * totals.images_us / frames},
                          {"reuse_ms", 1e-3 * reuse.images_us / frames}});
  }
}

// The paper's rates by part and by polygon, which follow from its assumption and the penalty for aggregation.
struct AssumedRates {
  std::uint32_t grid = 0;
  double unit = 0.0, poly = 0.0;
};
constexpr double kAircraftRate = 20.0, kTerrainRate = 70.0, kSkyRate = 40.0;
constexpr AssumedRates kAssumed[] = {
    {20, 58.3, 41.8}, {14, 51.3, 38.0}, {10, 48.7, 40.4}, {7, 51.9, 42.4}, {5, 71.5, 72.0}};

Experiment ratesTable() {
  return {
      "update_rates",
      "The canyon's update rates, percent of visible parts in a frame (first line of each grid: assumed in "
      "the paper)",
      "aircraft 20 %, terrain 70 %, sky 40 %, whatever is aggregated 100 %",
      {{"grid", "grid"},
       {"tolerance", "tolerance px", 2},
       {"aircraft", "aircraft", 1},
       {"terrain", "terrain", 1},
       {"sky", "sky", 1},
       {"unit", "unit agg", 1},
       {"poly", "poly agg", 1}}};
}

// Adds the rows for one division of the canyon. expansion is the terrain's triangles after the split divided
// by those before it; rates by polygon are relative to the triangles before the split.
void addRates(const MovingScene& scene, std::uint32_t grid, double expansion, const SceneTotals& totals,
              Experiment& table) {
  Json assumed{{"grid", fmt::format("{0} x {0}", grid)},
               {"aircraft", kAircraftRate},
               {"terrain", kTerrainRate},
               {"sky", kSkyRate}};
  for (const AssumedRates& rates : kAssumed) {
    if (rates.grid == grid) {
      assumed["unit"] = rates.unit;
      assumed["poly"] = rates.poly;
    }
  }
  table.rows.push_back(std::move(assumed));
  for (const ReuseTotals& reuse : totals.reuses) {
    Json row{{"grid", "  measured"}, {"tolerance", reuse.tolerance_px}};
    PartCounts all;
    for (std::size_t i = 0; i < scene.classes.size(); ++i) {
      const PartCounts& counts = reuse.by_class[i];
      row[scene.classes[i]] = percent(counts.drawn_parts, counts.parts);
      all.parts += counts.parts;
      all.drawn_parts += counts.drawn_parts;
      all.drawn_triangles += counts.drawn_triangles;
      all.triangles += counts.triangles / (scene.classes[i] == "terrain" ? expansion : 1.0);
    }
    row["unit"] = percent(all.drawn_parts, all.parts);
    row["poly"] = percent(all.drawn_triangles, all.triangles);
    table.rows.push_back(std::move(row));
  }
}

}  // namespace

bool isPartInView(const MovingScene& scene, std::size_t part, const Mat4& world_from_part,
                  const Frustum& frustum) {
  const auto is_beyond = [&](const Plane& plane) {
    for (const std::uint32_t hull : scene.parts[part].hulls) {
      for (const Vec3d& vertex : scene.hulls[hull].vertices) {
        if (plane.evaluate(transformPoint(world_from_part, vertex)) >= 0.0) {
          return false;
        }
      }
    }
    return true;
  };
  return std::none_of(frustum.planes.begin(), frustum.planes.end(), is_beyond);
}

std::uint64_t trianglesOfClass(const MovingScene& scene, const std::string& name) {
  std::uint64_t triangles = 0;
  for (std::size_t part = 0; part < scene.parts.size(); ++part) {
    triangles +=
        scene.classes[scene.parts[part].class_of] == name ? scene.scene.objects[part].triangleCount() : 0;
  }
  return triangles;
}

SavedRenderingOptions savedRenderingOptions(const ReproduceOptions& options) {
  SavedRenderingOptions own;
  if (options.fewer_frames) {
    own.max_frames = kShortFrames;
    own.height = kShortHeight;
  }
  return own;
}

Result<std::vector<Experiment>> savedRendering(const SavedRenderingOptions& options) {
  Experiment saved = savedTable(options), rates = ratesTable();
  const auto unsplit = static_cast<double>(canyonTerrainTriangles({.grid = 1, .inflation = 0.0}));
  for (const std::uint32_t grid : options.grids) {
    ProgressBar progress(fmt::format("saved rendering, {0} x {0}", grid));
    const MovingScene scene = makeCanyon({.grid = grid});
    const Result<SceneTotals> totals = SceneRun::run(scene, canyonSorting(), options, progress);
    if (!totals) {
      return totals.error();
    }
    addRows(fmt::format("canyon {0} x {0}", grid), *totals, saved);
    const auto split = static_cast<double>(trianglesOfClass(scene, "terrain"));
    addRates(scene, grid, split / unsplit, *totals, rates);
  }
  if (options.toothpicks) {
    ProgressBar progress("saved rendering, toothpicks");
    const Result<SceneTotals> totals = SceneRun::run(makeToothpicks({}), {}, options, progress);
    if (!totals) {
      return totals.error();
    }
    addRows("toothpicks", *totals, saved);
  }
  return std::vector<Experiment>{std::move(saved), std::move(rates)};
}

}  // namespace sightline::tool
