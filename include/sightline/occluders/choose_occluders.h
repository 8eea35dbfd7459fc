#pragma once

// Dynamic occluder selection: the k best of the potential occluders for one view.

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

// Area-angle of an occluder (Coorg and Teller 1997; Bittner et al. 1998, eq. 1): larger is better, 0 when it
// is seen from a side that does not hide. Square metres per square metre; orthographic views: square metres.
double areaAngle(const Occluder& occluder, const View& view, AreaAngleDirection direction);

// Keeps its storage between frames.
class OccluderChooser {
 public:
  // The best of the occluders that belong to the given objects (each named at most once), best first, ties by
  // id; occluders wholly outside the frustum are passed over. object_bounds: by ObjectId.
  std::span<const OccluderId> choose(const View& view, const OccluderSet& set,
                                     std::span<const ObjectId> objects, std::span<const Box> object_bounds,
                                     const ChoiceSettings& settings);

  // The best of these occluders (each named at most once), in the same way; max_distance and bodies are not
  // regarded. What is not in the set, as of a database of another one, is passed over.
  std::span<const OccluderId> choose(const View& view, const OccluderSet& set,
                                     std::span<const OccluderId> candidates, const ChoiceSettings& settings);

  // The first of these occluders that may hide something in the view, in their order; what is not in the set
  // is passed over.
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
