#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/culling/culling_method.h"
#include "sightline/math/frustum.h"
#include "sightline/scene/object_boxes.h"

namespace sightline::culling {

// Tests what a method kept once more: an object is hidden where all of its boxes are.
class SeveralBoxes {
 public:
  // No boxes are used if they are not of as many objects, and those of an object only if the box around them
  // is exactly its own. Both arguments must outlive this.
  SeveralBoxes(const ObjectBoxes& boxes, std::span<const Box> object_bounds);

  // Removes from `visible` the objects whose boxes are all outside the frustum or hidden in the frame that
  // the method has built. The order of what stays does not change.
  void removeHidden(const Frustum& frustum, CullingMethod& method, std::vector<ObjectId>& visible);

 private:
  // An object of which no box has been seen yet.
  struct Candidate {
    std::uint32_t at;        // in `visible`
    std::uint32_t next = 0;  // so many of its boxes have been looked at
  };

  std::span<const Box> of(ObjectId object) const {
    return used_[object.value] != 0 ? boxes_.of(object) : std::span<const Box>();
  }

  // Candidates are the visible objects with several boxes of which the point that was seen last is not seen.
  void findCandidates(CullingMethod& method, std::span<const ObjectId> visible);
  // Asks for the next box of each candidate that the frustum does not cull. A candidate that has none left is
  // hidden.
  void askForNextBoxes(const Frustum& frustum, std::span<const ObjectId> visible);
  // Keeps as candidates the objects whose box was hidden, and remembers of the others which box was seen.
  void takeAnswers(std::span<const ObjectId> visible);

  const ObjectBoxes& boxes_;
  std::vector<std::uint8_t> used_;  // by object: whether its boxes are
  // By object: the box that was seen last, and a point of it that was seen. They are looked at first, which
  // saves time and changes no answer.
  std::vector<std::uint8_t> seen_;
  std::vector<Vec3f> seen_points_;
  std::vector<Candidate> candidates_, asked_;
  std::vector<MovingBox> asked_boxes_;
  std::vector<Vec3f> asked_points_;
  std::vector<std::uint8_t> points_seen_;
  std::vector<Visibility> answers_;
  std::vector<std::uint8_t> hidden_;  // by place in `visible`
};

}  // namespace sightline::culling
