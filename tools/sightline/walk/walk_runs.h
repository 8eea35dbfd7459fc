#pragma once

// The runs of several settings along one walk: frame by frame, each culls and draws the same view.

#include <vector>

#include "sightline/culling/measured_renderer.h"
#include "sightline/render/renderer.h"
#include "tools/sightline/walk/walk_record.h"

namespace sightline::tool {

std::vector<WalkRun> makeRuns(const std::vector<Setting>& settings, CullingData& data);

// Adds the frame's record to every run.
void cullFrame(std::vector<WalkRun>& runs, const CullingData& data, std::uint32_t frame, const View& view);

// Draws what each run kept in the frame that was culled last, and notes the time. Each frame begins with
// another run, so that none has the others' warm caches always. images: gets a picture a run; null: nothing
// is read back. measured: is told what each run's drawing took; null: nothing is.
void drawFrame(std::vector<WalkRun>& runs, const View& view, Renderer& renderer, std::vector<Image>* images,
               MeasuredRenderer* measured = nullptr);

}  // namespace sightline::tool
