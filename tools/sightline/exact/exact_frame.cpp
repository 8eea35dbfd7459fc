#include "tools/sightline/exact/exact_frame.h"

#include <algorithm>

namespace sightline::tool {
namespace {

class FrameSearch {
 public:
  FrameSearch(const ExactVisibility& oracle, const View& view, std::uint32_t object_count,
              const ExactSettings& settings, const ParallelFor& parallel_for)
      : oracle_(oracle),
        view_(view),
        object_count_(object_count),
        settings_(settings),
        parallel_for_(parallel_for) {}

  ExactFrame run() {
    castRays();
    decideTheRest();
    return std::move(frame_);
  }

 private:
  // Rays through pixels, along the silhouettes of what they show, and at all that they do not show.
  void castRays() {
    note(oracle_.visibleThroughPixels(view_, settings_.width, settings_.height, parallel_for_),
         SeenBy::kPixel);
    const std::vector<ObjectId> seen = objectsOf(frame_).witnessed;
    note(oracle_.visibleBesideEdges(view_, seen, settings_.edge_rays, parallel_for_), SeenBy::kAimedRay);
    note(oracle_.visibleByAimedRays(view_, notSeen(), settings_.aimed_rays, parallel_for_),
         SeenBy::kAimedRay);
  }

  // Notes what rays have reached, if exact arithmetic confirms it.
  void note(const std::vector<SeenPoint>& witnesses, SeenBy by) {
    std::vector<std::uint8_t> confirmed(witnesses.size());
    parallel_for_(static_cast<std::uint32_t>(witnesses.size()), [&](std::uint32_t begin, std::uint32_t end) {
      for (std::uint32_t i = begin; i < end; ++i) {
        confirmed[i] = !frame_.visible.contains(witnesses[i].object) && oracle_.confirm(view_, witnesses[i]);
      }
    });
    for (std::size_t i = 0; i < witnesses.size(); ++i) {
      if (confirmed[i] != 0) {
        frame_.visible.emplace(witnesses[i].object, Sighting{witnesses[i], by});
      }
    }
  }

  std::vector<ObjectId> notSeen() const {
    std::vector<ObjectId> objects;
    for (std::uint32_t o = 0; o < object_count_; ++o) {
      if (!frame_.visible.contains(ObjectId(o))) {
        objects.push_back(ObjectId(o));
      }
    }
    return objects;
  }

  // Looks through the gaps that nearer surfaces leave, or proves that there is none.
  void decideTheRest() {
    const std::vector<ObjectId> objects = notSeen();
    const std::vector<Decision> decisions = oracle_.decide(view_, objects, settings_.steps, parallel_for_);
    for (std::size_t i = 0; i < objects.size(); ++i) {
      if (decisions[i].verdict == Verdict::kVisible) {
        frame_.visible.emplace(objects[i], Sighting{decisions[i].witness, SeenBy::kGap});
      } else if (decisions[i].verdict == Verdict::kUndecided) {
        frame_.undecided.push_back(objects[i]);
      }
    }
  }

  const ExactVisibility& oracle_;
  const View& view_;
  const std::uint32_t object_count_;
  const ExactSettings& settings_;
  const ParallelFor& parallel_for_;
  ExactFrame frame_;
};

}  // namespace

std::string nameOf(SeenBy by) {
  return by == SeenBy::kPixel ? "pixel" : by == SeenBy::kAimedRay ? "aimed ray" : "gap";
}

ExactFrame exactFrame(const ExactVisibility& oracle, const View& view, std::uint32_t object_count,
                      const ExactSettings& settings, const ParallelFor& parallel_for) {
  return FrameSearch(oracle, view, object_count, settings, parallel_for).run();
}

ExactObjects objectsOf(const ExactFrame& frame) {
  ExactObjects objects{.undecided = frame.undecided};
  for (const auto& [object, sighting] : frame.visible) {
    objects.witnessed.push_back(object);
  }
  return objects;
}

void addBoxes(const ExactVisibility& oracle, const View& view, std::uint32_t object_count,
              const ExactSettings& settings, const ParallelFor& parallel_for, ExactObjects& objects) {
  std::vector<ObjectId> others;
  for (std::uint32_t o = 0; o < object_count; ++o) {
    if (!std::binary_search(objects.witnessed.begin(), objects.witnessed.end(), ObjectId(o))) {
      others.emplace_back(o);
    }
  }
  const std::vector<Decision> decisions = oracle.decideBoxes(view, others, settings.steps, parallel_for);
  for (std::size_t i = 0; i < others.size(); ++i) {
    if (decisions[i].verdict == Verdict::kVisible) {
      objects.boxes.push_back(others[i]);
    } else if (decisions[i].verdict == Verdict::kUndecided) {
      objects.undecided_boxes.push_back(others[i]);
    }
  }
}

}  // namespace sightline::tool
