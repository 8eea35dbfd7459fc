#pragma once

// Chooses the k best of the potential occluders for one view.

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "sightline/occluders/occluder_set.h"
#include "sightline/scene/camera.h"

namespace sightline {

// The direction V of the area-angle -A (N . V) / |D|^2.
enum class AreaAngleDirection : std::uint8_t {
  kView,      // the viewing direction, as printed in the papers: walls beside the viewer count for nothing
  kOccluder,  // from the eye to the occluder's centre: an estimate of its solid angle
};

struct ChoiceSettings {
  std::uint32_t count = 64;  // k
  AreaAngleDirection direction = AreaAngleDirection::kOccluder;
  double max_distance = 0.0;  // metres from the eye to an object's box (lambda); 0: no limit
  bool bodies = false;        // of objects: convex bodies count as one, and are named by their first face
};

// The area-angle of an occluder; larger is better, and 0 means that the eye sees a side that does not hide.
// In square metres per square metre; for orthographic views in square metres. Sources: Coorg and Teller 1997;
// Bittner et al. 1998, equation 1.
double areaAngle(const Occluder& occluder, const View& view, AreaAngleDirection direction);

// Chooses occluders frame by frame. Keeps its storage between frames; for one thread at a time.
class OccluderChooser {
 public:
  // The best occluders of the given objects (each named at most once), best first, ties by id. Occluders
  // wholly outside the frustum are passed over. object_bounds: one box for each ObjectId. The result is valid
  // until the next call.
  std::span<const OccluderId> choose(const View& view, const OccluderSet& set,
                                     std::span<const ObjectId> objects, std::span<const Box> object_bounds,
                                     const ChoiceSettings& settings);

  // The best of the candidates (each named at most once), chosen in the same way, but max_distance and bodies
  // have no effect. Candidates that are not in the set, as from a database of another set, are passed over.
  std::span<const OccluderId> choose(const View& view, const OccluderSet& set,
                                     std::span<const OccluderId> candidates, const ChoiceSettings& settings);

  // The first `count` candidates that may hide something in the view, in their order. Candidates that are not
  // in the set are passed over.
  std::span<const OccluderId> takeFirst(const View& view, const OccluderSet& set,
                                        std::span<const OccluderId> candidates, std::uint32_t count);

 private:
  void rank(const View& view, const OccluderSet& set, OccluderId id, const ChoiceSettings& settings);
  std::span<const OccluderId> takeBest(const View& view, const OccluderSet& set,
                                       const ChoiceSettings& settings);

  std::vector<std::pair<double, OccluderId>> ranked_;
  std::vector<OccluderId> chosen_;
};

}  // namespace sightline
