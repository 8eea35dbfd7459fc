#include "tools/sightline/reproduce/observer_speeds.h"

#include <algorithm>

#include "tools/sightline/command_line/progress_bar.h"
#include "tools/sightline/cull/cull_run.h"
#include "tools/sightline/reproduce/camera_path_line.h"

namespace sightline::tool {
namespace {

constexpr double kWalkingStep = 1.4 / 60.0;  // metres from frame to frame
constexpr std::uint32_t kSpeeds[] = {1, 2, 4, 8, 16, 32};
constexpr std::uint32_t kStretches = 4;   // spread over the camera path
constexpr std::uint32_t kMinCounted = 2;  // a speed with fewer frames in a stretch is left out

// Cullers that move along together, so that other load on the machine affects them alike.
struct Walkers {
  Culler frustum, coherent, incoherent, through_eye;

  void reset() {
    frustum.reset();
    coherent.reset();
    incoherent.reset();
    through_eye.reset();
  }
  void cull(const View& view) {
    frustum.cull(view);
    coherent.cull(view);
    incoherent.cull(view);
    through_eye.cull(view);
  }
};

Walkers makeWalkers(CullingData& data, const Setting& setting) {
  Setting frustum = setting, incoherent = setting, through_eye = setting;
  frustum.method = &methodNamed("frustum");
  incoherent.temporal_coherence = false;
  through_eye.plane_form = PlaneForm::kThroughEye;
  return {data.makeCuller(frustum), data.makeCuller(setting), data.makeCuller(incoherent),
          data.makeCuller(through_eye)};
}

void add(const Walkers& walkers, SpeedResult& sum) {
  sum.frames += 1;
  sum.frustum_us += walkers.frustum.stats().totalUs();
  sum.coherent_us += walkers.coherent.stats().totalUs();
  sum.incoherent_us += walkers.incoherent.stats().totalUs();
  sum.through_eye_us += walkers.through_eye.stats().totalUs();
  const auto relations = [&](const char* name) {
    return static_cast<double>(walkers.coherent.statistic("relations", name));
  };
  sum.reused += relations("reused");
  sum.unchanged += relations("unchanged");
  sum.rebuilt += relations("rebuilt");
}

struct Stretch {
  double begin = 0.0;       // in metres along the line
  std::uint32_t steps = 0;  // number of steps at walking speed
};

void walkStretch(Walkers& walkers, const CameraPathLine& line, const Vec3d& origin, const Stretch& stretch,
                 SpeedResult& sum) {
  walkers.reset();
  for (std::uint32_t step = 0; step <= stretch.steps; step += sum.speed) {
    walkers.cull(line.view(stretch.begin + step * kWalkingStep, origin));
    if (step > 0) {  // the first frame has nothing before it
      add(walkers, sum);
    }
  }
}

SpeedResult meanSpeed(SpeedResult sum) {
  for (double* value : {&sum.frustum_us, &sum.coherent_us, &sum.incoherent_us, &sum.through_eye_us,
                        &sum.reused, &sum.unchanged, &sum.rebuilt}) {
    *value /= static_cast<double>(sum.frames);
  }
  return sum;
}

}  // namespace

std::vector<SpeedResult> measureSpeeds(const SceneAndWalk& input, CullingData& data, const Setting& setting,
                                       std::uint32_t stretch_frames) {
  const CameraPathLine line(input.walk.path);
  const double spacing = line.length() / kStretches;  // from one stretch's beginning to the next one's
  const auto room = static_cast<std::uint32_t>(std::min(spacing / kWalkingStep, 1e9));
  const std::uint32_t steps = std::min(stretch_frames, room);
  std::vector<SpeedResult> sums;
  for (const std::uint32_t speed : kSpeeds) {
    if (steps / speed >= kMinCounted) {
      sums.push_back({speed});
    }
  }
  Walkers walkers = makeWalkers(data, setting);
  ProgressBar progress("walking at several speeds");
  for (std::uint32_t stretch = 0; stretch < kStretches; ++stretch) {
    for (SpeedResult& sum : sums) {
      walkStretch(walkers, line, input.scene.origin, {stretch * spacing, steps}, sum);
      // Half of a stretch's frames are walked at the slowest speed, a quarter at the next one, and so on.
      progress.update((stretch + 1.0 - 0.5 / sum.speed) / kStretches);
    }
  }
  std::transform(sums.begin(), sums.end(), sums.begin(), meanSpeed);
  return sums;
}

}  // namespace sightline::tool
