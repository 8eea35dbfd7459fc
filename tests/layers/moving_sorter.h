#pragma once

// A sorter with the parts of a moving scene, which it places in each frame.

#include <algorithm>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

#include "scenes/moving_scene.h"
#include "sightline/layers/layer_sorter.h"

namespace sightline {

class MovingSorter {
 public:
  MovingSorter(const MovingScene& scene, const LayerSettings& settings)
      : scene_(scene), sorter_(makeSorter(scene, settings)) {
    for (const MovingPlane& plane : scene.planes) {
      ruled_.emplace_back(plane.first, plane.second);
    }
    for (const MovingJoint& joint : scene.joints) {
      ruled_.emplace_back(joint.first, joint.second);
    }
    for (auto& [a, b] : ruled_) {
      std::tie(a, b) = std::minmax({a, b});
    }
    std::sort(ruled_.begin(), ruled_.end());
  }

  void pose(std::uint32_t frame) { sightline::pose(scene_, frame, poses_, sorter_); }
  const LayerOrder& update(std::uint32_t frame) {
    pose(frame);
    return sorter_.update(view(frame));
  }
  View view(std::uint32_t frame) const { return scene_.scene.paths[0].view(frame, {}); }

  const MovingScene& scene() const { return scene_; }
  LayerSorter& sorter() { return sorter_; }
  const std::vector<Mat4>& poses() const { return poses_; }
  bool hasRule(std::uint32_t a, std::uint32_t b) const {
    return std::binary_search(ruled_.begin(), ruled_.end(), std::pair(std::min(a, b), std::max(a, b)));
  }

 private:
  const MovingScene& scene_;
  LayerSorter sorter_;
  std::vector<Mat4> poses_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ruled_;
};

}  // namespace sightline
