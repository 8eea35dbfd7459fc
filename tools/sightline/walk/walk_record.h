#pragma once

// The results of `walk`: numbers of every frame for every setting, and what the pictures need.

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/sightline/cull/cull_run.h"
#include "tools/sightline/input/load.h"
#include "tools/sightline/methods/statistics.h"
#include "tools/sightline/walk/coverage_picture.h"

namespace sightline::tool {

struct FrameRecord {
  std::uint32_t frame = 0;
  std::size_t objects = 0;      // objects drawn
  std::uint64_t triangles = 0;  // triangles drawn
  double cull_us = 0.0, draw_us = 0.0;
  CullStats stats;
  std::vector<std::uint64_t> statistics{};  // in the order of WalkRun::statistics
  bool differs = false;  // the picture differs from that of view-frustum culling: something culled would show
  bool tie = false;      // the picture differs by ties of the depth buffer only

  double frameUs() const { return cull_us + draw_us; }
};

struct WalkRun {
  Setting setting;
  CullRun run;
  std::size_t hierarchy_nodes = 0;
  std::uint32_t hierarchy_depth = 0;
  std::vector<Statistic> statistics{};  // of the setting
  std::vector<FrameRecord> frames{};

  template <typename Of>
  double mean(Of of) const {
    double sum = 0.0;
    for (const FrameRecord& frame : frames) {
      sum += static_cast<double>(of(frame));
    }
    return frames.empty() ? 0.0 : sum / static_cast<double>(frames.size());
  }
  // The mean of a statistic over all frames; 0 if the setting has none of this name.
  double meanOf(std::string_view group, std::string_view name) const {
    for (std::size_t i = 0; i < statistics.size(); ++i) {
      if (statistics[i].group == group && statistics[i].name == name) {
        return mean([i](const FrameRecord& frame) { return frame.statistics[i]; });
      }
    }
    return 0.0;
  }
  // The largest value of a statistic in any frame.
  std::uint64_t peak(std::string_view group, std::string_view name) const {
    std::uint64_t most = 0;
    for (std::size_t i = 0; i < statistics.size(); ++i) {
      if (statistics[i].group == group && statistics[i].name == name) {
        for (const FrameRecord& frame : frames) {
          most = std::max(most, frame.statistics[i]);
        }
      }
    }
    return most;
  }
  std::vector<std::uint32_t> differingFrames() const { return framesWhere(&FrameRecord::differs); }
  std::vector<std::uint32_t> tieFrames() const { return framesWhere(&FrameRecord::tie); }

 private:
  std::vector<std::uint32_t> framesWhere(bool FrameRecord::*is) const {
    std::vector<std::uint32_t> numbers;
    for (const FrameRecord& frame : frames) {
      if (frame.*is) {
        numbers.push_back(frame.frame);
      }
    }
    return numbers;
  }
};

// The result of culling one frame, kept for its pictures.
struct KeptFrame {
  std::uint32_t frame = 0;
  View view;
  std::vector<ObjectId> in_frustum, visible;
  std::vector<OccluderId> occluders;
  std::uint64_t triangles_in_frustum = 0, triangles_visible = 0;
  KeptDepthBuffer depth_buffer;  // empty if the method has none
  View depth_view;               // of that; wider than `view` where several views were culled at once
};

// A picture that culling has changed.
struct ChangedPicture {
  std::uint32_t frame = 0;
  std::string file, caption;
};

struct WalkRecord {
  std::vector<WalkRun> runs;        // [0] is the baseline: view-frustum culling
  std::size_t shown = 0;            // the index of the run whose pictures are shown
  std::vector<KeptFrame> pictures;  // ascending by frame
  std::vector<ChangedPicture> changed;
  std::uint32_t width = 0, height = 0;
  std::string device;  // the OpenGL implementation; empty if nothing was drawn

  const WalkRun& baseline() const { return runs.front(); }
  std::size_t differing() const {
    std::size_t sum = 0;
    for (const WalkRun& run : runs) {
      sum += run.differingFrames().size();
    }
    return sum;
  }
  std::size_t ties() const {
    std::size_t sum = 0;
    for (const WalkRun& run : runs) {
      sum += run.tieFrames().size();
    }
    return sum;
  }
};

}  // namespace sightline::tool
