#pragma once

// What a bake takes over, cell by cell, of the answers of an earlier bake, and its record of its own answers.

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "src/pvs/bake/bake_scene.h"
#include "src/pvs/bake/object_mask.h"
#include "src/pvs/bake/update/answers.h"
#include "src/pvs/bake/update/recall.h"

namespace sightline::pvs {

// Only one thread at a time may use it.
class CellRecall {
 public:
  // recall: the earlier bake; none if null. Both must outlive this.
  CellRecall(const BakeScene& scene, const Recall* recall);

  // All that follows is about this cell, a cellNumber.
  void startCell(std::uint64_t cell) { cell_ = cell; }
  // The earlier bake's answer to the same question; null if it did not ask.
  const Answer* find(const Answer& question);
  // Records an answer of this bake, if the settings ask for it.
  void keep(Answer answer);
  // The answers recorded since the last call.
  CellAnswers takeAnswers() { return std::exchange(answers_, {}); }

  enum class Known : std::uint8_t { kNothing, kHidden, kSeen };

  // For AnswerKind::kConvex: finds which objects the earlier answer still holds for, as seen from all of the
  // corners. hidden: the objects that this bake does not ask about. False if so much has changed that asking
  // each occluder is faster.
  bool compareObjects(const Answer& before, std::span<const Vec3d> corners, const ObjectMask& hidden);
  // After compareObjects(): what still holds about the object at this place. Where nothing does, it has to be
  // asked about.
  Known object(std::uint32_t position) const {
    return behind_.contains(position) ? Known::kNothing : objects_before_[position];
  }

  // For AnswerKind::kFused: what the earlier answer says about the nodes of its box tree; null if there is
  // none.
  void compareNodes(const Answer* before);
  struct NodeAnswer {
    bool hidden = false;
    CoarseBox followed{};  // the panels that decided it, in this scene's frame
  };
  // After compareNodes(): the answer about a node of this box tree, if it still holds for the region.
  std::optional<NodeAnswer> node(std::uint32_t number, const CellBox& region) const;

  // For AnswerKind::kPoint: sets answer.least and answer.most to bounds of the triangles that the point sees
  // now. False if nothing is known about it.
  bool boundTriangles(const Vec3d& eye, Answer& answer);

 private:
  // Sets behind_ to the objects of which the centre lies behind, or in, one of the boxes as seen from each
  // corner: all that occluders in these boxes may hide.
  void findBehind(std::span<const Vec3d> corners, std::span<const Box> boxes);
  // Whether the earlier answer about a node of this box tree still holds. decided_in: a box around the panels
  // that decided it.
  bool holds(std::uint32_t number, const CellBox& region, const Box& decided_in) const;

  const BakeScene& scene_;
  const Recall* recall_;
  std::optional<RecalledAnswers> answers_before_;
  std::vector<bool> occludes_;  // by place in the box tree: some convex occluder is the object's
  CellAnswers answers_;
  std::uint64_t cell_ = 1;
  // Scratch for the current question.
  ObjectMask behind_;
  std::vector<Box> differing_;
  std::vector<Known> objects_before_;       // by place now
  std::vector<Known> nodes_before_;         // by node of the earlier box tree; empty if there is no answer
  std::vector<CoarseBox> followed_before_;  // by node of the earlier box tree
};

}  // namespace sightline::pvs
