#pragma once

// Measures all settings on a scene: exact visibility, preparation, culling, drawing, and the advice.

#include <string>
#include <vector>

#include "tools/sightline/bench/bench_record.h"
#include "tools/sightline/bench/bench_runs.h"
#include "tools/sightline/command_line/threads.h"
#include "tools/sightline/exact/exact_cache.h"
#include "tools/sightline/input/load.h"

namespace sightline::tool {

struct BenchSettings {
  std::uint32_t rounds = 5;     // walks along the path that are measured
  std::uint32_t steps = 20000;  // ExactSettings::steps
  bool draw = false;
  PictureOptions picture{};  // to draw
};

struct BenchInput {
  SceneAndWalk data;
  double load_us = 0.0;  // what it took to load it
};

class SceneBench {
 public:
  // methods: the first is the baseline. threads: for everything but culling. cache outlives this object.
  SceneBench(std::vector<Setting> methods, const BenchSettings& settings, const ExactCache& cache,
             std::uint32_t threads)
      : methods_(std::move(methods)), settings_(settings), cache_(cache), threads_(threads) {}

  // Takes the baked file out of the input.
  BenchRecord measure(const std::string& name, BenchInput& input);

 private:
  // Exact visibility of all views, from the cache as far as it is there.
  std::vector<ExactObjects> exactFrames(const Scene& scene, const std::vector<View>& views,
                                        BenchRecord& record);
  // Which objects a test of several boxes must keep, likewise.
  void countSeveralBoxes(const SceneAndWalk& input, const std::vector<View>& views,
                         const std::vector<ExactObjects>& exact, BenchRecord& record);
  ExactSettings exactSettings() const;
  // A cache that cannot be written does not change the results, so it is only said, once.
  void keep(const ExactKey& key, const ExactObjects& frame);
  void run(BenchInput& input, const std::vector<View>& views, const std::vector<ExactObjects>& exact,
           const PictureOptions& size, BenchRecord& record);
  void draw(const SceneView& scene, std::vector<BenchRun>& runs, const std::vector<View>& views,
            const PictureOptions& size, BenchRecord& record) const;

  std::vector<Setting> methods_;
  BenchSettings settings_;
  const ExactCache& cache_;
  Threads threads_;
  bool told_ = false;  // that the cache cannot be written
};

}  // namespace sightline::tool
