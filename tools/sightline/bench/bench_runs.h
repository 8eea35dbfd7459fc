#pragma once

// Measures all settings on one scene in one interleaved run.

#include <functional>
#include <vector>

#include "sightline/render/renderer.h"
#include "tools/sightline/bench/bench_record.h"
#include "tools/sightline/exact/exact_frame.h"
#include "tools/sightline/input/load.h"

namespace sightline::tool {

// A setting's culler and what was measured with it.
struct BenchRun {
  SettingRecord record;
  Culler culler;
  // Microseconds of each frame, round after round.
  std::vector<double> cull_us{}, cpu_us{}, draw_us{};
};

// occluders: what it took to find those of the scene.
std::vector<BenchRun> makeBenchRuns(const std::vector<Setting>& settings, CullingData& data);

// Is told the fraction that is done, between two frames.
using Done = std::function<void(double)>;

// Walks through all views once with every setting, without measuring times. Notes what was kept, and the
// memory that each method has allocated. exact: one for each view.
void warmUp(std::vector<BenchRun>& runs, const std::vector<View>& views,
            const std::vector<ExactObjects>& exact);

// Walks through all views `rounds` times. All settings cull a view one after the other. The setting that
// begins changes from view to view, and their order is turned round from round to round, so that drift of the
// machine and warm caches are the same for all.
void measureCulling(std::vector<BenchRun>& runs, const std::vector<View>& views, std::size_t rounds,
                    const Done& done);

// Measures, in rounds as measureCulling() does, how long drawing takes of what each setting keeps.
void measureDrawing(std::vector<BenchRun>& runs, const std::vector<View>& views, std::size_t rounds,
                    Renderer& renderer, const Done& done);

}  // namespace sightline::tool
