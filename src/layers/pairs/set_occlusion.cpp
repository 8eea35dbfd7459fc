#include "src/layers/pairs/set_occlusion.h"

#include <algorithm>

#include "src/layers/pairs/swept_set.h"

namespace sightline::layers {

bool SetOcclusion::occludes(const ConvexSet& front, const ConvexSet& back) const {
  ConvexSet swept = back;
  if (!view_.orthographic) {
    swept.kind = ConvexSet::Kind::kWithEye;
    swept.eye_or_sweep = view_.eye;
    swept.more_eyes = more_eyes_;
  } else if (!sweepPast(view_.forward, front, swept)) {
    return false;
  }
  PairWitness witness;
  PairCounts counts;
  return testIntersection(front, swept, witness, counts) != Intersection::kDisjoint;
}

bool SetOcclusion::occludes(std::span<const ConvexSet> front, std::span<const ConvexSet> back) const {
  return std::any_of(front.begin(), front.end(), [&](const ConvexSet& f) {
    return std::any_of(back.begin(), back.end(), [&](const ConvexSet& b) { return occludes(f, b); });
  });
}

}  // namespace sightline::layers
