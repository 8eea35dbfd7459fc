#include "tools/sightline/walk/walk_runs.h"

namespace sightline::tool {

std::vector<WalkRun> makeRuns(const std::vector<Setting>& settings, CullingData& data) {
  std::vector<WalkRun> runs;
  for (const Setting& setting : settings) {
    CullRun run{data.makeCuller(setting)};
    const Hierarchy& hierarchy = data.hierarchy(setting.hierarchy);
    runs.push_back({setting, std::move(run), hierarchy.nodes.size(), hierarchy.depth, statisticsOf(setting)});
  }
  return runs;
}

void cullFrame(std::vector<WalkRun>& runs, const CullingData& data, std::uint32_t frame, const View& view) {
  // The order rotates from frame to frame, so that no run always profits from another's warm caches.
  const std::size_t first = runs.front().frames.size();
  for (std::size_t k = 0; k < runs.size(); ++k) {
    WalkRun& run = runs[(first + k) % runs.size()];
    run.run.cull(view);
    const std::span<const ObjectId> visible = run.run.culler.visible();
    FrameRecord record;
    record.frame = frame;
    record.objects = visible.size();
    record.triangles = data.trianglesOf(visible);
    record.cull_us = run.run.cull_us;
    record.stats = run.run.culler.stats();
    record.statistics = statisticValues(run.statistics, run.run.culler);
    run.frames.push_back(record);
  }
}

void drawFrame(std::vector<WalkRun>& runs, const View& view, Renderer& renderer, std::vector<Image>* images,
               MeasuredRenderer* measured) {
  const std::size_t first = runs.front().frames.size() - 1;
  if (first == 0) {
    renderer.time(view, runs.front().run.culler.visible());  // warms up
  }
  for (std::size_t k = 0; k < runs.size(); ++k) {
    const std::size_t r = (first + k) % runs.size();
    const std::span<const ObjectId> visible = runs[r].run.culler.visible();
    DrawStats stats;
    if (images != nullptr) {
      (*images)[r] = renderer.draw(view, visible, &stats);
    } else {
      stats = renderer.time(view, visible);
    }
    runs[r].frames.back().draw_us = stats.draw_us;
    if (measured != nullptr) {
      measured->frame(stats.draw_us, stats.triangles);
    }
  }
}

}  // namespace sightline::tool
