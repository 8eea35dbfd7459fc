#pragma once

// What a bake can take over from the answers of an earlier bake, of the scene before a change.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sightline/hierarchy/box_tree.h"
#include "src/pvs/bake/shaft.h"
#include "src/pvs/bake/update/answers.h"
#include "src/pvs/bake/update/earlier_bake.h"

namespace sightline::pvs {

// An object is the same if its mark has the same content. All others of both scenes have changed: an object
// that was moved is one that is gone and one that has come. Immutable.
class Recall {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  // scene must outlive this. Precondition: the settings and the space of both marks are equal.
  Recall(EarlierBake earlier, const BakeScene& scene, const SceneMarks& marks);

  const EarlierBake& earlier() const { return earlier_; }
  // The place of an object in the box tree of the earlier bake, by its place now; kNone if it has changed.
  std::uint32_t placeBefore(std::uint32_t position) const { return before_[position]; }
  // Its place now, by its place in the earlier bake; kNone if it has changed.
  std::uint32_t placeNow(std::uint32_t position_before) const { return now_[position_before]; }
  // A node of the earlier box tree with the same box, or the leaf of the same object; kNone if there is none.
  std::uint32_t nodeBefore(std::uint32_t node) const { return node_before_[node]; }

  // Boxes around all that convex occluders of changed objects hid or hide with.
  std::span<const Box> changedOccluders() const { return changed_occluders_; }
  // Triangles of the changed objects, before and now.
  std::uint64_t trianglesGone() const { return triangles_gone_; }
  std::uint64_t trianglesCome() const { return triangles_come_; }
  std::uint32_t objectsGone() const { return objects_gone_; }
  std::uint32_t objectsCome() const { return objects_come_; }
  // False only if no changed panel, of either scene, meets any line of sight from the region to the box.
  bool panelsDiffer(const CellBox& region, const Box& box) const;
  // False only if no changed panel meets the box.
  bool panelsDiffer(const Box& box) const;

  // The part of the earlier bake that has the answers about a cell; 0 if there is none.
  std::uint64_t partOf(std::uint64_t cell) const;

 private:
  void matchObjects(const SceneMarks& marks);
  void matchNodes(const BakeScene& scene);
  void comparePanels(const SceneMarks& marks);

  EarlierBake earlier_;
  std::vector<std::uint32_t> before_, now_, node_before_;
  std::vector<Box> changed_occluders_;
  BoxTree changed_panels_;
  std::uint64_t triangles_gone_ = 0, triangles_come_ = 0;
  std::uint32_t objects_gone_ = 0, objects_come_ = 0;
  double magnitude_, slack_;
};

// The answers of an earlier bake, for one thread: those of one part are decoded at a time.
class RecalledAnswers {
 public:
  explicit RecalledAnswers(const Recall& recall) : recall_(recall) {}

  // The answer that the earlier bake found; null if it did not ask.
  const Answer* find(std::uint64_t cell, AnswerKind kind, std::uint64_t question);

 private:
  const Recall& recall_;
  std::uint64_t part_ = 0;
  CellAnswers answers_;  // of that part
};

}  // namespace sightline::pvs
