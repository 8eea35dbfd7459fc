#include "tools/sightline/layers/layer_eyes.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

namespace sightline::tool {
namespace {

Vec3d between(const Vec3d& a, const Vec3d& b, double share) {
  return a + (b - a) * share;
}
Mat4 between(const Mat4& a, const Mat4& b, double share) {
  Mat4 result;
  for (std::size_t i = 0; i < a.m.size(); ++i) {
    result.m[i] = a.m[i] + (b.m[i] - a.m[i]) * share;
  }
  return result;
}

}  // namespace

void addLayerEyeOptions(CLI::App& command, LayerEyeOptions& options) {
  command
      .add_option("--order-for", options.order_for,
                  "what the order is right for: the eye, or every point of the lens and every time of the "
                  "shutter (default: lens for pictures blurred by layers, else eye)")
      ->check(isOneOf({"eye", "lens"}));
  addDecimalOption(command, "--stereo", options.stereo, 0.0, 1000.0,
                   "metres between two eyes, left and right of the camera: the order is right for both");
}

std::string orderFor(const LayerEyeOptions& options, const LayerLensOptions& lens) {
  if (!options.order_for.empty()) {
    return options.order_for;
  }
  const bool by_layers =
      lens.depth_of_field == "layers" || (lens.depth_of_field.empty() && lens.motion_blur > 0.0);
  return by_layers ? "lens" : "eye";
}

std::vector<Vec3d> lensEyes(const View& view, double aperture) {
  std::vector<Vec3d> eyes;
  if (view.orthographic || !(aperture > 0.0)) {
    return eyes;
  }
  const double half = 0.5 * aperture;
  for (int corner = 0; corner < 8; ++corner) {
    eyes.push_back(view.eye + Vec3d((corner & 1) != 0 ? half : -half, (corner & 2) != 0 ? half : -half,
                                    (corner & 4) != 0 ? half : -half));
  }
  return eyes;
}

EyeSorter::EyeSorter(const LayerEyeOptions& options, const LayerLensOptions& lens, const LayerInput& input,
                     const LayerSettings& settings)
    : input_(input),
      settings_(settings),
      for_lens_(orderFor(options, lens) == "lens"),
      stereo_(options.stereo),
      aperture_(lens.depth_of_field.empty() ? 0.0 : lens.aperture),
      motion_blur_(lens.motion_blur),
      sorter_(makeSorter(input.moving, settings)) {}

void EyeSorter::place(std::uint32_t frame, const View& view) {
  if (moves() && input_.moving.pose && motionFrame(input_.walk, frame)) {
    sweep(frame);
  } else {
    pose(input_.moving, frame, poses_, sorter_);
  }
  findEyes(frame, view);
}

void EyeSorter::findEyes(std::uint32_t frame, const View& view) {
  more_eyes_.clear();
  if (view.orthographic) {
    return;
  }
  if (!for_lens_) {
    if (stereo_ > 0.0) {
      more_eyes_ = {view.eye - view.right * (0.5 * stereo_), view.eye + view.right * (0.5 * stereo_)};
    }
    return;
  }
  std::vector<View> ends{view};
  if (const std::optional<std::uint32_t> other = moves() ? motionFrame(input_.walk, frame) : std::nullopt) {
    const Vec3d later = input_.walk.view(*other, input_.moving.scene).eye;
    ends.push_back(view);
    ends[0].eye = between(view.eye, later, -0.5 * motion_blur_);
    ends[1].eye = between(view.eye, later, 0.5 * motion_blur_);
  }
  for (const View& end : ends) {
    // The cube holds the lenses of both eyes, also where the camera turns while the shutter is open.
    const std::vector<Vec3d> eyes = lensEyes(end, aperture_ + stereo_);
    more_eyes_.push_back(end.eye);
    more_eyes_.insert(more_eyes_.end(), eyes.begin(), eyes.end());
  }
}

// Makes a sorter of the hulls that parts sweep while the shutter is open. A rule is of one place of a part,
// so only those between parts that stay are kept.
void EyeSorter::sweep(std::uint32_t frame) {
  const MovingScene& moving = input_.moving;
  poses_.resize(moving.parts.size());
  other_poses_.resize(moving.parts.size());
  moving.pose(frame, poses_);
  moving.pose(*motionFrame(input_.walk, frame), other_poses_);
  MovingScene swept;
  swept.parts = moving.parts;
  std::vector<bool> stays;
  for (std::size_t part = 0; part < moving.parts.size(); ++part) {
    const Mat4 first = between(poses_[part], other_poses_[part], -0.5 * motion_blur_);
    const Mat4 last = between(poses_[part], other_poses_[part], 0.5 * motion_blur_);
    stays.push_back(poses_[part].m == other_poses_[part].m);
    for (std::uint32_t& hull : swept.parts[part].hulls) {
      const ConvexHull& own = moving.hulls[hull];
      Result<ConvexHull> all = stays.back() ? Result<ConvexHull>(own) : sweptHull(own, first, last);
      // A hull without points has no place, so that its part is taken to be anywhere.
      swept.hulls.push_back(all ? std::move(*all) : ConvexHull{});
      hull = static_cast<std::uint32_t>(swept.hulls.size() - 1);
    }
  }
  const auto stay = [&](const auto& rule) { return stays[rule.first] && stays[rule.second]; };
  std::copy_if(moving.planes.begin(), moving.planes.end(), std::back_inserter(swept.planes), stay);
  std::copy_if(moving.joints.begin(), moving.joints.end(), std::back_inserter(swept.joints), stay);
  sorter_ = makeSorter(swept, settings_);
  for (std::size_t part = 0; part < stays.size(); ++part) {
    if (stays[part]) {
      sorter_.setTransform(PartId(part), poses_[part]);
    }
  }
}

}  // namespace sightline::tool
