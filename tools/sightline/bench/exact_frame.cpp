#include "tools/sightline/bench/exact_frame.h"

namespace sightline::tool {
namespace {

// The objects that have been reached so far.
class Reached {
 public:
  explicit Reached(std::uint32_t object_count) : reached_(object_count, false) {}

  void add(const std::vector<Witness>& witnesses) {
    for (const Witness& witness : witnesses) {
      reached_[witness.object.value] = true;
    }
  }
  // Returns the objects that were reached (true) or not (false), ascending.
  std::vector<ObjectId> objects(bool reached) const {
    std::vector<ObjectId> chosen;
    for (std::uint32_t o = 0; o < reached_.size(); ++o) {
      if (reached_[o] == reached) {
        chosen.push_back(ObjectId(o));
      }
    }
    return chosen;
  }

 private:
  std::vector<bool> reached_;
};

}  // namespace

ExactFrame exactFrame(const ExactVisibility& oracle, const View& view, std::uint32_t object_count,
                      const ExactSettings& settings, const ParallelFor& parallel_for) {
  Reached reached(object_count);
  reached.add(oracle.visibleThroughPixels(view, settings.width, settings.height, parallel_for));
  reached.add(oracle.visibleBesideEdges(view, reached.objects(true), settings.rays, parallel_for));
  reached.add(oracle.visibleByAimedRays(view, reached.objects(false), settings.rays, parallel_for));
  return {reached.objects(true), {}};
}

}  // namespace sightline::tool
