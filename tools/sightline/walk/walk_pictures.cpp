#include "tools/sightline/walk/walk_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "tools/sightline/walk/walk_report.h"

namespace sightline::tool {
namespace {

constexpr std::size_t kSpread = 4;
constexpr double kRoofAbove = 8.0;    // a surface overhead within so many metres means indoors
constexpr float kRoofWidth = 1.5f;    // its smallest size in metres, in both directions
constexpr double kCutAboveEye = 0.5;  // metres between the eye and the cut of an indoor plan
constexpr double kMinRadius = 8.0;    // of a plan, in metres

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

Image drawPlanOf(const KeptFrame& frame, const Scene& scene, const OccluderSet& occluders,
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

// A picture of the depth buffer, top row first. shade(reciprocal depth) is the grey of a pixel.
template <typename Shade>
Image depthBufferImage(const KeptDepthBuffer& buffer, Shade&& shade) {
  Image image{buffer.width, buffer.height, {}};
  for (std::uint32_t y = buffer.height; y-- > 0;) {
    for (std::uint32_t x = 0; x < buffer.width; ++x) {
      const std::uint8_t grey = shade(buffer.reciprocal_depth[std::size_t{y} * buffer.width + x]);
      image.rgba.insert(image.rgba.end(), {grey, grey, grey, 255});
    }
  }
  return image;
}

Image coverageImage(const KeptDepthBuffer& buffer) {
  return depthBufferImage(
      buffer, [](float reciprocal_depth) -> std::uint8_t { return reciprocal_depth > kUncovered ? 255 : 0; });
}

// Greys from the farthest (dark) to the nearest (white) in equal steps of rank, so that all distances can be
// distinguished.
Image depthImage(const KeptDepthBuffer& buffer) {
  std::vector<float> sorted;
  std::copy_if(buffer.reciprocal_depth.begin(), buffer.reciprocal_depth.end(), std::back_inserter(sorted),
               [](float reciprocal_depth) { return reciprocal_depth > kUncovered; });
  std::sort(sorted.begin(), sorted.end());
  return depthBufferImage(buffer, [&](float reciprocal_depth) -> std::uint8_t {
    if (!(reciprocal_depth > kUncovered)) {
      return 0;
    }
    const auto rank = std::lower_bound(sorted.begin(), sorted.end(), reciprocal_depth) - sorted.begin();
    return static_cast<std::uint8_t>(64 + 191 * rank / static_cast<std::ptrdiff_t>(sorted.size()));
  });
}

double coveredShare(const KeptDepthBuffer& buffer) {
  const auto covered = std::count_if(buffer.reciprocal_depth.begin(), buffer.reciprocal_depth.end(),
                                     [](float reciprocal_depth) { return reciprocal_depth > kUncovered; });
  return static_cast<double>(covered) / static_cast<double>(buffer.reciprocal_depth.size());
}

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

Result<std::vector<ReportPicture>> drawPictures(const WalkRecord& record, const Scene& scene,
                                                const OccluderSet& occluders, Renderer& renderer,
                                                const std::string& folder) {
  std::vector<ReportPicture> pictures;
  const auto add = [&](const Image& image, const std::string& file, const std::string& caption,
                       std::uint32_t frame, bool plan) {
    pictures.push_back({file, caption, frame, plan});
    return writePng(image, folder + "/" + file);
  };
  for (const KeptFrame& frame : record.pictures) {
    const std::string drawn =
        fmt::format("{} of {} triangles in the frustum drawn ({:.1f} %)", grouped(frame.triangles_visible),
                    grouped(frame.triangles_in_frustum), 100.0 * shareKept(frame));
    const Status picture = add(renderer.draw(frame.view, frame.visible),
                               fmt::format("frame_{:04}.png", frame.frame), drawn, frame.frame, false);
    const Status plan = add(
        drawPlanOf(frame, scene, occluders, renderer), fmt::format("plan_{:04}.png", frame.frame),
        fmt::format("{} objects kept, {} hidden in the frustum, {} occluders", grouped(frame.visible.size()),
                    grouped(frame.in_frustum.size() - frame.visible.size()), grouped(frame.occluders.size())),
        frame.frame, true);
    if (!picture || !plan) {
      return picture ? plan.error() : picture.error();
    }
    if (!frame.depth_buffer.reciprocal_depth.empty()) {
      const std::string size =
          fmt::format("{} x {} pixels", frame.depth_buffer.width, frame.depth_buffer.height);
      const Status coverage =
          add(coverageImage(frame.depth_buffer), fmt::format("coverage_{:04}.png", frame.frame),
              fmt::format("coverage map, {}: {:.1f} % covered by occluders", size,
                          100.0 * coveredShare(frame.depth_buffer)),
              frame.frame, false);
      const Status depth =
          add(depthImage(frame.depth_buffer), fmt::format("depth_{:04}.png", frame.frame),
              fmt::format("depth map, {}: white is near, black is not covered", size), frame.frame, false);
      if (!coverage || !depth) {
        return coverage ? depth.error() : coverage.error();
      }
    }
  }
  return pictures;
}

}  // namespace sightline::tool
