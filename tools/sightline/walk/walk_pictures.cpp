#include "tools/sightline/walk/walk_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "sightline/occlusion/rasteriser.h"
#include "tools/sightline/report/depth_legend.h"
#include "tools/sightline/report/markup.h"
#include "tools/sightline/walk/coverage_picture.h"
#include "tools/sightline/walk/walk_report.h"

namespace sightline::tool {
namespace {

constexpr std::size_t kSpread = 4;
constexpr double kRoofAbove = 8.0;    // a surface overhead within so many metres means indoors
constexpr float kRoofWidth = 1.5f;    // its smallest size in metres, in both directions
constexpr double kCutAboveEye = 0.5;  // metres between the eye and the cut of an indoor plan
constexpr double kMinRadius = 8.0;    // of a plan, in metres
// Pixels: so wide is the picture of a depth buffer at least, that its single pixels can be seen.
constexpr std::uint32_t kMinCoverageWidth = 960;

double shareKept(const KeptFrame& frame) {
  return frame.triangles_in_frustum > 0
             ? static_cast<double>(frame.triangles_visible) / static_cast<double>(frame.triangles_in_frustum)
             : 1.0;
}

// Whether something wide and opaque is right overhead, so that a plan from above would show a roof only.
bool indoors(const Vec3d& eye, const Scene& scene) {
  for (const Object& object : scene.objects) {
    const Box& box = object.bounds;
    const bool overhead = box.min.x <= eye.x && eye.x <= box.max.x && box.min.z <= eye.z &&
                          eye.z <= box.max.z && box.min.y > eye.y && box.min.y < eye.y + kRoofAbove;
    if (overhead && scene.materials[object.material.value].opaque() && box.extent().x > kRoofWidth &&
        box.extent().z > kRoofWidth) {
      return true;
    }
  }
  return false;
}

// The radius in metres around the eye within which nine tenths of the objects in the frustum lie.
double radiusAround(const KeptFrame& frame, const Scene& scene) {
  std::vector<double> distances;
  for (const ObjectId object : frame.in_frustum) {
    const Vec3d away = center(scene.objects[object.value].bounds) - frame.view.eye;
    distances.push_back(std::hypot(away.x, away.z));
  }
  if (distances.empty()) {
    return kMinRadius;
  }
  const auto nine_tenths = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() * 9 / 10);
  std::nth_element(distances.begin(), nine_tenths, distances.end());
  return std::max(kMinRadius, 1.15 * *nine_tenths);
}

// The value of a statistic of the shown run in a frame; empty if the run has no such one.
std::optional<std::uint64_t> statisticOf(const WalkRecord& record, std::uint32_t frame,
                                         std::string_view group, std::string_view name) {
  const WalkRun& run = record.runs[record.shown];
  for (const FrameRecord& of_frame : run.frames) {
    for (std::size_t i = 0; of_frame.frame == frame && i < run.statistics.size(); ++i) {
      if (run.statistics[i].group == group && run.statistics[i].name == name) {
        return of_frame.statistics[i];
      }
    }
  }
  return std::nullopt;
}

// What covers the pixels of the frame's map. With surfaces and occluders, the occluders are drawn once more
// alone.
CoverageMap coverageOf(const WalkRecord& record, const KeptFrame& frame, const OccluderSet& occluders) {
  const Setting& setting = record.runs[record.shown].setting;
  const bool surfaces = setting.surfaces() != SurfaceUse::kNone;
  KeptDepthBuffer alone;
  if (surfaces && !frame.occluders.empty()) {
    Rasteriser rasteriser(setting.raster);
    rasteriser.begin(frame.depth_view);
    rasteriser.draw(occluders, frame.occluders);
    alone = copyOf(rasteriser.depthBuffer());
  }
  return coverageMap(frame.depth_buffer, alone, surfaces ? CoveredBy::kSurface : CoveredBy::kOccluder,
                     frame.depth_view.orthographic);
}

// 0.6984 -> "69.8"; only all of it is "100.0".
std::string percentText(double share) {
  return fmt::format("{:.1f}", share < 1.0 ? std::min(100.0 * share, 99.9) : 100.0);
}

// "Coverage map, 320 x 180: 40,231 of 57,600 pixels are covered (69.8 %), from 2.1 m to 310 m away. ..."
std::string coverageCaption(const WalkRecord& record, const KeptFrame& frame, const CoverageMap& map) {
  std::string text =
      fmt::format("Coverage map, {} x {}: {} of {} pixels are covered ({} %)", map.width, map.height,
                  grouped(map.covered()), grouped(map.covered_by.size()), percentText(map.share()));
  if (map.covered() == 0) {
    return text + ".";
  }
  text += fmt::format(", from {} to {} away.", depthText(map.scale.nearest), depthText(map.scale.farthest));
  const bool surfaces = record.runs[record.shown].setting.surfaces() != SurfaceUse::kNone;
  const auto groups = statisticOf(record, frame.frame, "surfaces", "groups");
  const auto edges = statisticOf(record, frame.frame, "surfaces", "edges");
  if (surfaces && groups && edges) {
    text += fmt::format(" Surfaces: {} pixels, {} groups with {} edges.", grouped(map.by_surfaces),
                        grouped(*groups), grouped(*edges));
  }
  if (!frame.occluders.empty()) {
    text += fmt::format(" Chosen occluders: {} pixels, {} occluders.", grouped(map.by_occluders),
                        grouped(frame.occluders.size()));
  }
  return text;
}

// Draws the pictures of a walk's chosen frames one after the other, until one is not taken.
class PictureMaker {
 public:
  PictureMaker(const WalkRecord& record, const Scene& scene, const OccluderSet& occluders, Renderer* renderer,
               const TakePicture& take)
      : record_(record), scene_(scene), occluders_(occluders), renderer_(renderer), take_(take) {}

  Result<std::vector<ReportPicture>> makeAll() {
    for (const KeptFrame& frame : record_.pictures) {
      if (renderer_ != nullptr) {
        addRendered(frame);
      }
      if (!frame.depth_buffer.empty()) {
        addCoverage(frame);
      }
      if (renderer_ != nullptr) {
        addPlan(frame);
      }
      if (!taken_) {
        return taken_.error();
      }
    }
    return std::move(pictures_);
  }

 private:
  void addRendered(const KeptFrame& frame) {
    const std::string drawn =
        fmt::format("{} of {} triangles in the frustum drawn ({:.1f} %)", grouped(frame.triangles_visible),
                    grouped(frame.triangles_in_frustum), 100.0 * shareKept(frame));
    add(renderer_->draw(frame.view, frame.visible), "frame", {.caption = drawn, .frame = frame.frame});
  }

  void addCoverage(const KeptFrame& frame) {
    const CoverageMap map = coverageOf(record_, frame, occluders_);
    add(coverageImage(map, frame.depth_view.aspect, std::max(record_.width, kMinCoverageWidth)), "coverage",
        {.caption = coverageCaption(record_, frame, map), .frame = frame.frame, .coverage = true});
  }

  void addPlan(const KeptFrame& frame) {
    const std::string objects =
        fmt::format("{} objects kept, {} hidden in the frustum, {}", grouped(frame.visible.size()),
                    grouped(frame.in_frustum.size() - frame.visible.size()),
                    record_.runs[record_.shown].setting.surfaces() == SurfaceUse::kAlone
                        ? "whole surfaces as occluders"
                        : grouped(frame.occluders.size()) + " occluders");
    add(planPicture(frame, scene_, occluders_, *renderer_), "plan",
        {.caption = objects, .frame = frame.frame, .plan = true});
  }

  void add(Image image, std::string_view kind, ReportPicture picture) {
    picture.file = fmt::format("{}_{:04}.png", kind, picture.frame);
    if (taken_) {
      taken_ = take_(std::move(image), picture.file);
    }
    pictures_.push_back(std::move(picture));
  }

  const WalkRecord& record_;
  const Scene& scene_;
  const OccluderSet& occluders_;
  Renderer* renderer_;
  const TakePicture& take_;
  Status taken_ = Success{};
  std::vector<ReportPicture> pictures_;
};

}  // namespace

PictureChooser::PictureChooser(std::vector<std::uint32_t> frames) {
  for (std::size_t i = 0; i < kSpread && !frames.empty(); ++i) {
    spread_.push_back(frames[(2 * i + 1) * frames.size() / (2 * kSpread)]);
  }
}

void PictureChooser::offer(const KeptFrame& frame) {
  if (std::find(spread_.begin(), spread_.end(), frame.frame) != spread_.end()) {
    kept_.push_back(frame);
  }
  if (!best_ || shareKept(frame) < shareKept(*best_)) {
    best_ = frame;
  }
}

std::vector<KeptFrame> PictureChooser::chosen() const {
  std::vector<KeptFrame> frames = kept_;
  const auto same = [&](const KeptFrame& frame) { return frame.frame == best_->frame; };
  if (best_ && std::none_of(frames.begin(), frames.end(), same)) {
    frames.push_back(*best_);
  }
  std::sort(frames.begin(), frames.end(), [](const auto& a, const auto& b) { return a.frame < b.frame; });
  return frames;
}

Image planPicture(const KeptFrame& frame, const Scene& scene, const OccluderSet& occluders,
                  Renderer& renderer) {
  std::vector<ObjectState> states(scene.objects.size(), ObjectState::kOutside);
  for (const ObjectId object : frame.in_frustum) {
    states[object.value] = ObjectState::kHidden;
  }
  for (const ObjectId object : frame.visible) {
    states[object.value] = ObjectState::kKept;
  }
  PlanView plan;
  plan.camera = frame.view;
  plan.radius = radiusAround(frame, scene);
  if (indoors(frame.view.eye, scene)) {
    plan.cut_height = frame.view.eye.y + kCutAboveEye;
  }
  plan.states = states;
  plan.objects = scene.objects;
  plan.occluders = &occluders;
  plan.occluders_used = frame.occluders;
  return renderer.drawPlan(plan);
}

KeptFrame keptFrame(const WalkRecord& record, const CullingData& data, std::uint32_t frame,
                    const View& view) {
  const Culler& all = record.baseline().run.culler;
  const Culler& shown = record.runs[record.shown].run.culler;
  KeptFrame kept;
  kept.frame = frame;
  kept.view = view;
  kept.in_frustum.assign(all.visible().begin(), all.visible().end());
  kept.visible.assign(shown.visible().begin(), shown.visible().end());
  kept.occluders.assign(shown.occludersUsed().begin(), shown.occludersUsed().end());
  kept.depth_buffer = copyOf(shown.depthBuffer());
  kept.depth_view = shown.depthBufferView();
  kept.triangles_in_frustum = data.trianglesOf(kept.in_frustum);
  kept.triangles_visible = data.trianglesOf(kept.visible);
  return kept;
}

Result<std::vector<ReportPicture>> drawPictures(const WalkRecord& record, const Scene& scene,
                                                const OccluderSet& occluders, Renderer* renderer,
                                                const TakePicture& take) {
  return PictureMaker(record, scene, occluders, renderer, take).makeAll();
}

}  // namespace sightline::tool
