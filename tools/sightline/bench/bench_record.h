#pragma once

// The results of `bench`: of each scene, and of each setting on it.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sightline/pvs/format/scene_id.h"
#include "tools/sightline/bench/frame_times.h"
#include "tools/sightline/input/crack_note.h"
#include "tools/sightline/methods/setting.h"

namespace sightline::tool {

// The time and memory that one part of the preparation took. bytes: none if unknown.
struct PartCost {
  double us = 0.0;
  std::optional<std::size_t> bytes = 0;
};

// What a setting needs before its first frame. A part that it does not need costs nothing; parts that several
// settings share count for each.
struct Preparation {
  PartCost hierarchy{}, occluders{}, databases{};
  PartCost method{};  // the culler itself; its bytes include what its first walk allocates

  double us() const { return hierarchy.us + occluders.us + databases.us + method.us; }
  std::optional<std::size_t> bytes() const {
    std::size_t sum = 0;
    for (const PartCost& part : {hierarchy, occluders, databases, method}) {
      if (!part.bytes) {
        return {};
      }
      sum += *part.bytes;
    }
    return sum;
  }
};

// The least and the greatest value that a number may have.
struct Interval {
  double low = 0.0, high = 0.0;
};

struct SettingRecord {
  Setting setting;
  std::uint64_t kept = 0;     // objects, over all frames
  std::uint64_t missed = 0;   // objects that are visible but were not kept, over all frames
  std::uint64_t answers = 0;  // hash of the objects kept in each frame
  FrameTimes cull{};          // microseconds of the wall clock
  FrameTimes cpu{};           // microseconds of the thread's own processor time
  std::optional<FrameTimes> draw{};
  Preparation preparation{};
  bool on_front = false;

  // Microseconds of processor time for culling a mean frame. It counts what delays the method itself, but not
  // what other programs do.
  double cullingUs() const { return cpu.mean.value; }
  // Microseconds of a mean frame: culling, and drawing if it was measured.
  double frameUs() const { return cullingUs() + (draw ? draw->mean.value : 0.0); }
};

// The setting that a user of the scene is advised to take, and why.
struct Advice {
  std::size_t run = 0;
  std::string sentence{};
};

struct BenchRecord {
  std::string scene_name{}, path_name{};
  SceneId scene{};
  CrackNote cracks{};
  std::uint64_t views = 0;  // hash of the views of all frames
  std::size_t frames = 0, rounds = 0;
  std::optional<int> core{};    // to which the measuring thread was pinned; none: it was not
  std::string device{};         // the OpenGL implementation; empty if nothing was drawn
  double load_us = 0.0;         // scene, camera path and baked file
  std::uint64_t witnessed = 0;  // objects, over all frames
  std::uint64_t undecided = 0;  // objects, over all frames
  // Objects whose bounding boxes are visible, over all frames: any test of one box an object must keep them.
  std::uint64_t boxes = 0;
  std::uint64_t undecided_boxes = 0;  // not among them
  // Objects of which a box is visible, of the up to kMaxObjectBoxes that findObjectBoxes() gives an object.
  std::uint64_t several_boxes = 0, undecided_several_boxes = 0;
  std::size_t frames_from_cache = 0;  // frames whose exact visibility was kept from an earlier run
  std::vector<SettingRecord> runs{};  // [0] is the baseline: view-frustum culling
  Advice advice{};

  const SettingRecord& baseline() const { return runs.front(); }
  // Kept objects for each exactly visible one; none if no object was seen.
  std::optional<Interval> overestimate(const SettingRecord& run) const { return overestimateOf(run.kept); }
  // The least that a test of one bounding box an object can have.
  std::optional<Interval> leastOfBoxes() const { return overestimateOf(boxes); }
  // The least that a test of several boxes an object can have.
  std::optional<Interval> leastOfSeveralBoxes() const { return overestimateOf(several_boxes); }

 private:
  std::optional<Interval> overestimateOf(std::uint64_t objects) const {
    if (witnessed == 0) {
      return {};
    }
    const auto kept = static_cast<double>(objects);
    return Interval{kept / static_cast<double>(witnessed + undecided), kept / static_cast<double>(witnessed)};
  }
};

}  // namespace sightline::tool
