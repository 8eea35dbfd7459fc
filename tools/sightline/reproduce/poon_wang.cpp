// The experiments of Poon and Wang 1999, section 6: figures 6, 8, 9 and 10, and the depth comparisons of
// section 5.3.
//
// Differs from the paper in: scenes, machine and renderer are those of today. Occluders cover only pixels
// that lie wholly inside them; the paper's sampling at pixel centres, which culls visible objects, stands
// beside it. The adaptive overlap test follows measured times, of culling and of drawing, only in the rows
// that say so.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "oracle/exact_visibility.h"
#include "sightline/comparison/centre_coverage.h"
#include "tools/sightline/bench/frame_times.h"
#include "tools/sightline/command_line/names.h"
#include "tools/sightline/command_line/progress_bar.h"
#include "tools/sightline/command_line/threads.h"
#include "tools/sightline/report/markup.h"
#include "tools/sightline/reproduce/papers.h"
#include "tools/sightline/reproduce/poon_wang.h"
#include "tools/sightline/walk/walk_report.h"
#include "tools/sightline/walk/walk_runs.h"

namespace sightline::tool {
namespace {

constexpr const char* kRoutes[] = {"best", "average", "worst"};
constexpr OccluderChoice kCriteria[] = {OccluderChoice::kProjectedSize, OccluderChoice::kMinimumSets,
                                        OccluderChoice::kFirstHit};
constexpr std::uint32_t kCounts[] = {16, 32, 64, 96, 128, 192, 256, 384, 512};
constexpr std::uint32_t kOccluders = 64;          // occluders in each frame of the routes
constexpr std::uint32_t kPicture = 512;           // width and height of pictures, unless the user gives them
constexpr double kPictures[] = {1.0, 1.5, 2.0};   // sizes of figure 10, relative to that
constexpr std::uint32_t kTopViewOccluders = 192;  // of figure 7, for each criterion
constexpr std::uint32_t kMap = 128;               // width and height of the opacity map
constexpr std::size_t kVisibleWanted = 400;       // visible objects at figure 6's viewpoint
constexpr std::size_t kRepeats = 15;              // repetitions of that viewpoint's frame

Setting frustumSetting() {
  Setting setting;
  setting.method = &methodNamed("frustum");
  return setting;
}

Setting opacitySetting(OccluderChoice criterion, std::uint32_t occluders) {
  Setting setting;
  setting.method = &methodNamed("opacity-map");
  setting.raster = {.width = kMap, .height = kMap};
  setting.occluders = criterion;
  setting.culler.occluders.count = occluders;
  setting.viewpoints.criterion = criterionOf(criterion);
  return setting;
}

PictureOptions pictureOf(const ReproduceOptions& options) {
  CameraPath square;
  square.width = square.height = kPicture;
  return pictureSize(options.picture, square);
}

PictureOptions scaled(const PictureOptions& picture, double factor) {
  return {static_cast<std::uint32_t>(picture.width * factor),
          static_cast<std::uint32_t>(picture.height * factor)};
}

std::string sizeText(const PictureOptions& picture) {
  return fmt::format("{} x {}", picture.width, picture.height);
}

Walk inPictures(Walk walk, const PictureOptions& picture) {
  walk.path.width = picture.width;
  walk.path.height = picture.height;
  return walk;
}

// The scene's routes, or the chosen walk if the user names one or the scene has no routes.
Result<std::vector<Walk>> routesOf(const SceneAndWalk& input, const ReproduceOptions& options) {
  Result<std::vector<Walk>> routes = namedWalks(input, options, kRoutes);
  if (routes) {
    for (Walk& route : *routes) {
      route = inPictures(std::move(route), pictureOf(options));
    }
  }
  return routes;
}

// The frame of the walk that shows about as many objects as the paper's viewpoint shows primitives.
struct Viewpoint {
  std::uint32_t frame = 0;
  std::size_t objects = 0;
};
Viewpoint viewpointOf(const SceneAndWalk& input, const Walk& walk, const ParallelFor& parallel_for) {
  ExactVisibility oracle(input.scene.view());
  Viewpoint best;
  const auto away = [](std::size_t objects) {
    return std::abs(static_cast<double>(objects) - static_cast<double>(kVisibleWanted));
  };
  const std::size_t step = std::max<std::size_t>(walk.frames.size() / 10, 1);
  for (std::size_t i = 0; i < walk.frames.size(); i += step) {
    const View view = walk.view(walk.frames[i], input.scene);
    const std::size_t objects =
        oracle.visibleThroughPixels(view, walk.path.width, walk.path.height, parallel_for).size();
    if (i == 0 || away(objects) < away(best.objects)) {
      best = {walk.frames[i], objects};
    }
  }
  return best;
}

// The results of one setting along one route or at one viewpoint.
struct SceneRuns {
  std::string name;
  double cull_ms = 0.0, draw_ms = 0.0;  // means of a frame
  double triangles = 0.0;
  double depth_tests = 0.0, depths_compared = 0.0, sparse_rows = 0.0;  // means of a frame
  double suspended = 0.0;  // share of the frames without occlusion culling
  std::vector<double> frame_ms{};

  double frameMs() const { return cull_ms + draw_ms; }
  double fps() const { return 1e3 / frameMs(); }
};

SceneRuns measuredOf(const std::string& name, const WalkRun& run) {
  SceneRuns measured{name};
  measured.cull_ms = run.mean([](const FrameRecord& frame) { return frame.cull_us * 1e-3; });
  measured.draw_ms = run.mean([](const FrameRecord& frame) { return frame.draw_us * 1e-3; });
  measured.triangles = run.mean([](const FrameRecord& frame) { return frame.triangles; });
  measured.depth_tests = run.meanOf("map", "depth_tests");
  measured.depths_compared = run.meanOf("map", "depths_compared");
  measured.sparse_rows = run.meanOf("map", "sparse_rows");
  measured.suspended = run.meanOf("map", "suspended");
  for (const FrameRecord& frame : run.frames) {
    measured.frame_ms.push_back(frame.frameUs() * 1e-3);
  }
  return measured;
}

// All that is measured on one scene.
class Experiments {
 public:
  // Precondition: there is at least one route.
  Experiments(const std::string& name, const SceneAndWalk& input, std::vector<Walk> routes,
              const ReproduceOptions& options, const ParallelFor& parallel_for)
      : name_(name),
        input_(input),
        options_(options),
        picture_(pictureOf(options)),
        routes_(std::move(routes)),
        walk_(inPictures(input.walk, picture_)),
        viewpoint_(viewpointOf(input, walk_, parallel_for)),
        data_(input.scene, parallel_for, allViewpoints()) {
    for (std::uint32_t o = 0; o < input.scene.objects.size(); ++o) {
      everything_.push_back(ObjectId(o));
    }
    useRenderer(picture_);
  }

  bool drawn() const { return renderer_.has_value(); }
  std::string whyNot() const { return why_not_; }
  // One for each route that was drawn: what its adaptive overlap test went by.
  const std::vector<std::string>& notes() const { return notes_; }
  // Figures 7 and 11; none if nothing was drawn.
  const poon_wang::Pictures& pictures() const { return pictures_; }

  void run(poon_wang::Tables& tables) {
    occluderCounts(tables.occluder_counts);
    if (renderer_) {
      drawPictures();
    }
    routes(tables.routes, tables.depth_comparison);
    criteria(tables.criteria);
    pictureSizes(tables.picture_sizes);
  }

  Report report() const {
    Report report;
    report.title = "Poon and Wang 1999: " + name_;
    report.summary =
        "Opacity map with sparse depth map, occluders of minimum sets, against view-frustum culling.";
    report.command = options_.command_line;
    report.facts = {{"objects", grouped(input_.scene.objects.size())},
                    {"triangles", grouped(input_.scene.triangleCount())},
                    {"potential occluders", grouped(data_.occluders().occluders.size())},
                    {"OpenGL", drawn() ? renderer_->device() : "none: nothing was drawn"}};
    report.plots = plots_;
    report.pictures = pictures_.pictures;
    return report;
  }

 private:
  // The viewpoints for which the viewpoint database is built: all routes and the viewpoint of figure 6.
  Walk allViewpoints() const {
    Walk all = walk_;
    all.path.frames = {walk_.path.frames[viewpoint_.frame]};
    for (const Walk& route : routes_) {
      for (const std::uint32_t frame : route.frames) {
        all.path.frames.push_back(route.path.frames[frame]);
      }
    }
    all.frames.resize(all.path.frames.size());
    for (std::uint32_t i = 0; i < all.frames.size(); ++i) {
      all.frames[i] = i;
    }
    return all;
  }

  void useRenderer(const PictureOptions& picture) {
    Result<Renderer> renderer = Renderer::create(input_.scene.view(), picture.width, picture.height);
    renderer_.reset();
    if (renderer) {
      renderer_.emplace(std::move(*renderer));
    } else {
      why_not_ = renderer.error().message;
    }
  }

  // Walks a route with all settings side by side. "Nil", which culls nothing, comes first if it is asked for.
  // measured_renderer: is told what the drawing of each takes; null: nothing is.
  std::vector<SceneRuns> walkRoute(const Walk& route, const std::vector<std::string>& names,
                                   const std::vector<Setting>& settings, bool with_nil,
                                   MeasuredRenderer* measured_renderer = nullptr) {
    std::vector<WalkRun> runs = makeRuns(settings, data_);
    SceneRuns nil{"nil"};
    nil.triangles = static_cast<double>(input_.scene.triangleCount());
    ProgressBar progress("walking " + route.path.name);
    for (std::size_t i = 0; i < route.frames.size(); ++i) {
      const View view = route.view(route.frames[i], input_.scene);
      cullFrame(runs, data_, route.frames[i], view);
      if (renderer_) {
        drawFrame(runs, view, *renderer_, nullptr, measured_renderer);
        if (with_nil) {
          nil.frame_ms.push_back(renderer_->time(view, everything_).draw_us * 1e-3);
          nil.draw_ms += nil.frame_ms.back() / static_cast<double>(route.frames.size());
        }
      }
      progress.update(static_cast<double>(i + 1) / static_cast<double>(route.frames.size()));
    }
    std::vector<SceneRuns> measured;
    if (with_nil) {
      measured.push_back(nil);
    }
    for (std::size_t r = 0; r < runs.size(); ++r) {
      measured.push_back(measuredOf(names[r], runs[r]));
    }
    return measured;
  }

  Json row(const SceneRuns& measured, const SceneRuns& frustum) const {
    Json json = {{"scene", name_},
                 {"culling", measured.name},
                 {"triangles", measured.triangles},
                 {"culled_percent", 100.0 * (1.0 - measured.triangles / std::max(1.0, frustum.triangles))},
                 {"cull_ms", measured.cull_ms}};
    if (drawn()) {
      json["frame_ms"] = measured.frameMs();
      json["fps"] = measured.fps();
      json["speed_up"] = frustum.frameMs() / measured.frameMs();
    }
    return json;
  }

  void addPlot(const std::string& title, const std::string& y_label, const std::vector<SceneRuns>& measured) {
    if (!drawn()) {
      return;
    }
    Plot plot;
    plot.title = title;
    plot.y_label = y_label;
    for (const SceneRuns& one : measured) {
      plot.series.push_back({one.name, one.frame_ms});
    }
    plots_.push_back(std::move(plot));
  }

  // Figure 6.
  void occluderCounts(Experiment& experiment) {
    const View view = walk_.view(viewpoint_.frame, input_.scene);
    const auto measureAt = [&](const std::string& name, const Setting& setting) {
      Culler culler = data_.makeCuller(setting);
      SceneRuns measured{name};
      std::vector<double> cull, draw;
      for (std::size_t i = 0; i < kRepeats; ++i) {
        culler.cull(view);
        cull.push_back(culler.stats().totalUs() * 1e-3);
        draw.push_back(renderer_ ? renderer_->time(view, culler.visible()).draw_us * 1e-3 : 0.0);
      }
      measured.cull_ms = medianOf(cull);
      measured.draw_ms = medianOf(draw);
      measured.triangles = static_cast<double>(data_.trianglesOf(culler.visible()));
      return measured;
    };
    measureAt("", frustumSetting());  // warms up
    const SceneRuns frustum = measureAt(poon_wang::kFrustum, frustumSetting());
    Plot rates{.title = "Figure 6: frame rate by the number of occluders",
               .x_label = "number of occluders: "};
    Plot culled{.title = "Figure 6: triangles culled by the number of occluders", .x_label = rates.x_label};
    rates.y_label = "frames/s";
    culled.y_label = "% of the frustum's";
    for (const std::uint32_t count : kCounts) {
      culled.x_label = rates.x_label += fmt::format("{}{}", count == kCounts[0] ? "" : ", ", count);
    }
    for (const OccluderChoice criterion : kCriteria) {
      const std::string name = nameOf(kOccluderChoices, criterion);
      rates.series.push_back({name});
      culled.series.push_back({name});
      for (const std::uint32_t count : kCounts) {
        const SceneRuns measured = measureAt(name, opacitySetting(criterion, count));
        Json json = row(measured, frustum);
        json["occluders"] = count;
        json["visible_objects"] = viewpoint_.objects;
        culled.series.back().values.push_back(json["culled_percent"].get<double>());
        rates.series.back().values.push_back(measured.fps());
        experiment.rows.push_back(std::move(json));
      }
    }
    plots_.push_back(std::move(culled));
    if (drawn()) {
      plots_.push_back(std::move(rates));
    }
  }

  // Figures 7 and 11.
  void drawPictures() {
    const View view = walk_.view(viewpoint_.frame, input_.scene);
    std::vector<std::pair<std::string, Setting>> criteria;
    for (const OccluderChoice criterion : kCriteria) {
      criteria.emplace_back(nameOf(kOccluderChoices, criterion),
                            opacitySetting(criterion, kTopViewOccluders));
    }
    Culler frustum = data_.makeCuller(frustumSetting());
    poon_wang::addTopViews(input_.scene, data_, view, frustum, criteria, *renderer_, pictures_);
    poon_wang::addBirdsEyeView(input_.scene, walk_.path, *renderer_, pictures_);
  }

  // The rows of one route: the way of comparing depths for each of `measured` that tests depths as the paper
  // does.
  void addDepthComparisons(const std::string& route, const std::vector<SceneRuns>& measured,
                           Experiment& experiment) const {
    const auto named = [&](const char* name) {
      return *std::find_if(measured.begin(), measured.end(),
                           [&](const SceneRuns& one) { return one.name == name; });
    };
    const double pixels = std::max(1.0, named(poon_wang::kPixelwise).depths_compared);
    for (const char* name : {poon_wang::kPixelwise, poon_wang::kOpacityMap, poon_wang::kPeaksAlways}) {
      const SceneRuns one = named(name);
      experiment.rows.push_back({{"scene", name_},
                                 {"route", route},
                                 {"culling", name},
                                 {"depth_tests", one.depth_tests},
                                 {"depths_compared", one.depths_compared},
                                 {"percent_of_pixelwise", 100.0 * one.depths_compared / pixels},
                                 {"sparse_rows", one.sparse_rows},
                                 {"cull_ms", one.cull_ms}});
    }
  }

  // Figure 8, and section 5.3.
  void routes(Experiment& experiment, Experiment& depths) {
    for (const Walk& route : routes_) {
      const Setting om = opacitySetting(OccluderChoice::kMinimumSets, kOccluders);
      Setting pixelwise = om, peaks = om, adaptive = om, centre = om;
      pixelwise.opacity_map.map.depth = DepthComparison::kPixelwise;
      peaks.opacity_map.map.depth = DepthComparison::kSparseAlways;
      centre.raster.coverage = centreCoverage();
      std::vector<std::string> names{poon_wang::kFrustum, poon_wang::kOpacityMap, poon_wang::kPixelwise,
                                     poon_wang::kPeaksAlways, "OM, centres (not conservative)"};
      std::vector<Setting> settings{frustumSetting(), om, pixelwise, peaks, centre};
      MeasuredRenderer renderer;  // hears of the drawing of all these, which differ in triangles
      if (drawn()) {
        adaptive.opacity_map.renderer = &renderer;
        names.push_back("OM, adaptive");
        settings.push_back(adaptive);
      }
      const std::vector<SceneRuns> measured = walkRoute(route, names, settings, true, &renderer);
      if (const std::optional<double> us = renderer.triangleUs()) {
        notes_.push_back(fmt::format(
            "{}, route {}: the adaptive overlap test followed the renderer, which took {:.3f} us for a "
            "triangle in the end, and did without occlusion culling in {:.0f} % of the frames.",
            name_, route.path.name, *us, 100.0 * measured.back().suspended));
      }
      for (const SceneRuns& one : measured) {
        experiment.rows.push_back(row(one, measured[1]));
        experiment.rows.back()["route"] = route.path.name;
      }
      addDepthComparisons(route.path.name, measured, depths);
      addPlot("Figure 8: frame time, route " + route.path.name, "ms", measured);
    }
  }

  // Figure 9, on the first route.
  void criteria(Experiment& experiment) {
    std::vector<std::string> names{poon_wang::kFrustum};
    std::vector<Setting> settings{frustumSetting()};
    for (const OccluderChoice criterion : kCriteria) {
      names.push_back(nameOf(kOccluderChoices, criterion));
      settings.push_back(opacitySetting(criterion, kOccluders));
    }
    const std::vector<SceneRuns> measured = walkRoute(routes_.front(), names, settings, false);
    for (const SceneRuns& one : measured) {
      experiment.rows.push_back(row(one, measured[0]));
      experiment.rows.back()["route"] = routes_.front().path.name;
    }
    addPlot("Figure 9: frame time by criterion, route " + routes_.front().path.name, "ms", measured);
  }

  // Figure 10, on the first route.
  void pictureSizes(Experiment& experiment) {
    std::vector<SceneRuns> all;
    for (const double factor : kPictures) {
      const PictureOptions picture = scaled(picture_, factor);
      if (drawn() && factor != 1.0) {
        useRenderer(picture);
      }
      const std::vector<SceneRuns> measured =
          walkRoute(routes_.front(), {poon_wang::kFrustum, poon_wang::kOpacityMap},
                    {frustumSetting(), opacitySetting(OccluderChoice::kMinimumSets, kOccluders)}, false);
      for (const SceneRuns& one : measured) {
        experiment.rows.push_back(row(one, measured[0]));
        experiment.rows.back()["picture"] = sizeText(picture);
        all.push_back(one);
        all.back().name += ", " + sizeText(picture);
      }
    }
    addPlot("Figure 10: frame time by picture size, route " + routes_.front().path.name, "ms", all);
  }

  const std::string& name_;
  const SceneAndWalk& input_;
  const ReproduceOptions& options_;
  PictureOptions picture_;
  std::vector<Walk> routes_;
  Walk walk_;  // the walk that the user chose
  Viewpoint viewpoint_;
  CullingData data_;
  std::vector<ObjectId> everything_;
  std::optional<Renderer> renderer_;
  std::string why_not_;
  std::vector<std::string> notes_;
  poon_wang::Pictures pictures_;
  std::vector<Plot> plots_;
};

}  // namespace

Result<Reproduction> reproducePoonWang(const ReproduceOptions& options,
                                       const std::vector<SceneAndWalk>& inputs) {
  const Threads threads(options.threads);
  Reproduction result;
  poon_wang::Tables tables = poon_wang::emptyTables(sizeText(pictureOf(options)));
  std::vector<std::vector<Walk>> routes;
  for (const SceneAndWalk& input : inputs) {  // check all inputs before the work starts
    Result<std::vector<Walk>> of_scene = routesOf(input, options);
    if (!of_scene) {
      return of_scene.error();
    }
    routes.push_back(std::move(*of_scene));
  }
  std::vector<Finding> top_views;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    Experiments experiments(options.scenes[i], inputs[i], std::move(routes[i]), options,
                            threads.parallelFor());
    experiments.run(tables);
    if (!experiments.drawn()) {
      result.notes.push_back(
          fmt::format("{}: nothing was drawn: {}", options.scenes[i], experiments.whyNot()));
    }
    result.notes.insert(result.notes.end(), experiments.notes().begin(), experiments.notes().end());
    const poon_wang::Pictures& pictures = experiments.pictures();
    for (const ReportFile& file : pictures.files) {
      result.files.push_back(file);
      result.files.back().report = i;
    }
    if (!pictures.pictures.empty()) {
      top_views.push_back(poon_wang::topViewFinding(options.scenes[i], pictures));
    }
    result.reports.push_back(experiments.report());
  }
  poon_wang::addPublished(tables);
  result.findings = poon_wang::findingsOf(tables);
  result.findings.insert(result.findings.end(), top_views.begin(), top_views.end());
  result.experiments = {std::move(tables.occluder_counts), std::move(tables.routes),
                        std::move(tables.depth_comparison), std::move(tables.criteria),
                        std::move(tables.picture_sizes)};
  return result;
}

}  // namespace sightline::tool
