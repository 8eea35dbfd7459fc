#include "src/culling/several_boxes.h"

#include <algorithm>

namespace sightline::culling {

namespace {

// Whether the rows of boxes are those of so many objects.
bool areRows(const ObjectBoxes& boxes, std::size_t objects) {
  return boxes.first.size() == objects + 1 && boxes.first.front() == 0 &&
         std::is_sorted(boxes.first.begin(), boxes.first.end()) && boxes.first.back() == boxes.boxes.size();
}

}  // namespace

SeveralBoxes::SeveralBoxes(const ObjectBoxes& boxes, std::span<const Box> object_bounds)
    : boxes_(boxes),
      used_(object_bounds.size(), 0),
      seen_(object_bounds.size(), 0),
      seen_points_(object_bounds.size()) {
  const bool rows = areRows(boxes, object_bounds.size());
  for (std::size_t i = 0; rows && i < object_bounds.size(); ++i) {
    used_[i] = areBoxesOf(boxes.of(ObjectId(i)), object_bounds[i]) ? 1 : 0;
    if (used_[i] != 0) {
      seen_points_[i] = Vec3f(center(boxes.of(ObjectId(i)).front()));
    }
  }
}

void SeveralBoxes::removeHidden(const Frustum& frustum, CullingMethod& method,
                                std::vector<ObjectId>& visible) {
  findCandidates(method, visible);
  hidden_.assign(visible.size(), 0);
  // All candidates at once, a box of each: most objects are seen by their first one.
  while (!candidates_.empty()) {
    askForNextBoxes(frustum, visible);
    answers_.resize(asked_boxes_.size());
    if (!asked_.empty()) {
      method.classify(asked_boxes_, answers_);
    }
    takeAnswers(visible);
  }
  std::size_t kept = 0;
  for (std::size_t at = 0; at < visible.size(); ++at) {
    if (hidden_[at] == 0) {
      visible[kept++] = visible[at];
    }
  }
  visible.resize(kept);
}

void SeveralBoxes::findCandidates(CullingMethod& method, std::span<const ObjectId> visible) {
  candidates_.clear();
  asked_points_.clear();
  for (std::uint32_t at = 0; at < visible.size(); ++at) {
    if (!of(visible[at]).empty()) {
      candidates_.push_back({at});
      asked_points_.push_back(seen_points_[visible[at].value]);
    }
  }
  points_seen_.resize(candidates_.size());
  method.seesPoints(asked_points_, points_seen_);
  std::size_t unseen = 0;
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    candidates_[unseen] = candidates_[i];
    unseen += points_seen_[i] == 0 ? 1 : 0;
  }
  candidates_.resize(unseen);
}

void SeveralBoxes::askForNextBoxes(const Frustum& frustum, std::span<const ObjectId> visible) {
  asked_.clear();
  asked_boxes_.clear();
  asked_points_.clear();
  for (Candidate candidate : candidates_) {
    const ObjectId object = visible[candidate.at];
    const std::span<const Box> boxes = of(object);
    bool in_view = false;
    while (!in_view && candidate.next < boxes.size()) {
      const Box& box = boxes[(seen_[object.value] + candidate.next++) % boxes.size()];
      std::uint8_t cut = kAllFrustumPlanes;
      in_view = sightline::classify(frustum, box, cut) != FrustumSide::kOutside;
      if (in_view) {
        asked_.push_back(candidate);
        asked_boxes_.push_back({box, cut});
        asked_points_.push_back(candidate.next == 1 ? seen_points_[object.value] : Vec3f(center(box)));
      }
    }
    hidden_[candidate.at] = in_view ? 0 : 1;
  }
  for (std::size_t i = 0; i < asked_boxes_.size(); ++i) {
    asked_boxes_[i].seen_point = &asked_points_[i];
  }
}

void SeveralBoxes::takeAnswers(std::span<const ObjectId> visible) {
  candidates_.clear();
  for (std::size_t i = 0; i < asked_.size(); ++i) {
    if (answers_[i] == Visibility::kHidden) {
      candidates_.push_back(asked_[i]);
    } else {
      const ObjectId object = visible[asked_[i].at];
      seen_[object.value] =
          static_cast<std::uint8_t>((seen_[object.value] + asked_[i].next - 1) % of(object).size());
      seen_points_[object.value] = asked_points_[i];
    }
  }
}

}  // namespace sightline::culling
