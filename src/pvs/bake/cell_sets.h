#pragma once

// Computes what may be seen from one cell.

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "src/pvs/bake/bake_counts.h"
#include "src/pvs/bake/bake_scene.h"
#include "src/pvs/bake/cell_occluders.h"
#include "src/pvs/bake/convex/cell_candidates.h"
#include "src/pvs/bake/convex/convex_search.h"
#include "src/pvs/bake/convex/samples.h"
#include "src/pvs/bake/dividing_gain.h"
#include "src/pvs/bake/doors/closed_doors.h"
#include "src/pvs/bake/object_mask.h"
#include "src/pvs/bake/seen_sets.h"
#include "src/pvs/bake/surfaces/node_occlusion.h"
#include "src/pvs/bake/update/cell_recall.h"
#include "src/pvs/bake/witness_recorder.h"

namespace sightline::pvs {

class CellBaker {
 public:
  // recall: an earlier bake, whose answers are used where they still hold; none if null. The sets are the
  // same with and without. Both must outlive this.
  explicit CellBaker(const BakeScene& scene, const Recall* recall = nullptr);
  CellBaker(const CellBaker&) = delete;
  CellBaker& operator=(const CellBaker&) = delete;

  // Sets of the cell. Convex occluders count that intersect the cell grown by search_distance metres on all
  // sides, surfaces wherever they are; these are narrowed and divided only if the cell cannot be divided.
  // seen: from anywhere in the parent, of which the sets are a part; empty if not known.
  CellSets seenFrom(const OctreeCell& cell, double search_distance, const Runs& seen);
  // Removes from the sets of a cell that could be divided, but is not, what surfaces hide where they are
  // narrowed and divided.
  void lookCloser(const OctreeCell& cell, CellSets& sets);
  // Updates the sets, computed with the smaller distance `searched`, to the greater search_distance.
  void lookFarther(const OctreeCell& cell, double searched, double search_distance, CellSets& sets);
  // Whether dividing the cell, which must be the last that sets were found for, helps; see DividingGain.
  bool dividingHelps(const OctreeCell& cell, double search_distance, const CellSets& sets) {
    return dividing_gain_.helps(cell, search_distance, sets);
  }
  // True if the cell is larger than what occluders near it are useful to. Points in it are then no fair
  // sample of what smaller cells see.
  bool tooLargeForItsOccluders(const OctreeCell& cell) const;
  // True if a larger search box would contain no further occluders.
  bool searchedAll(const OctreeCell& cell, double search_distance) const;

  // Adds what closed doors hide of the finished sets of a cell: by surfaces, and by single convex occluders
  // that intersect the cell grown by search_distance metres.
  void closeDoors(const OctreeCell& cell, double search_distance, CellSets& sets);

  // Discards samples until they fit their limit; called between cells.
  void forgetOldest() { samples_.forgetOldest(); }
  BakeStats stats() const;
  // BakeCounts::work of all that was asked so far.
  std::uint64_t work() const { return counts_.work + dividing_gain_.counts().work; }
  // The last cell is divided. Forgets what hides objects from the sides of its plane: the cells below it have
  // planes of their own, and if they become one cell again, it has theirs.
  void forgetSides() { witnesses_.forgetSides(); }
  // What hid objects since the last call; empty if the settings do not ask for it.
  std::vector<HidingWitness> takeWitnesses() { return witnesses_.take(); }
  // What was asked since the last call, and the answers; empty if the settings do not ask for it.
  CellAnswers takeAnswers() { return recall_.takeAnswers(); }

 private:
  // All that follows is about this cell.
  void startCell(const OctreeCell& cell);
  bool fused() const { return scene_.settings.occlusion == BakeOcclusion::kFused; }
  // Removes from each set what the chosen occluders hide from its region (the cell, or a side of its plane).
  void removeHidden(const CellBox& box, CellSets& sets);
  void removeHiddenFrom(std::span<const Vec3d> corners, WitnessPart part, Runs& seen);
  // Lists of what may hide the objects that the current cell's parent sees; null if there are none.
  const CellCandidates* listsAround();
  // Adds to hidden_ what the chosen occluders hide from all corners, by asking each of them.
  void hideByChosen(std::span<const Vec3d> corners);
  // The same by what an earlier bake found. False, with nothing added, if too much has changed for that.
  bool hideAsBefore(const Answer& before, std::span<const Vec3d> corners, const Runs& seen);
  // The same by samples, which are kept.
  void hideBySamples(std::span<const Vec3d> corners);
  // Removes from each set what surfaces hide from its region, of what lies in the boxes of the tree.
  void removeFused(const CellBox& box, const RegionEffort& effort, CellSets& sets);
  void removeFusedFrom(const CellBox& region, WitnessPart part, const RegionEffort& effort, Runs& seen);
  void removeFusedBelow(std::uint32_t node, const CellBox& region, const RegionEffort& effort);
  // Whether the node's box is hidden, by what an earlier bake found or by asking.
  bool surfacesHide(std::uint32_t node, const CellBox& region, const RegionEffort& effort);

  const BakeScene& scene_;
  CellRecall recall_;
  ConvexSearch search_;
  SampleStore samples_;
  NodeOcclusion surfaces_;
  CellOccluders occluders_;  // of the current cell
  DividingGain dividing_gain_;
  ClosedDoors closed_doors_;
  WitnessRecorder witnesses_;
  // By level: lists of the last cell there within which something was asked.
  struct Handed {
    std::uint64_t cell = 0;  // its number; 0 if there is none
    bool usable = false;     // false if they would be too long
    CellCandidates lists;
  };
  std::deque<Handed> handed_;
  Runs parent_seen_;  // from anywhere in the current cell's parent; empty: not known
  // Scratch for the current cell.
  std::vector<DividingFace> faces_;
  ObjectMask hidden_, hidden_from_parent_;
  ObjectMask seen_from_side_;  // of the whole cell that is asked about; otherwise none
  Runs common_, scratch_;
  std::vector<std::uint32_t> hidden_nodes_;
  std::vector<CoarseBox> followed_;
  BakeCounts counts_;       // without what dividing_gain_ counts
  std::uint64_t cell_ = 1;  // cellNumber of the current cell
};

}  // namespace sightline::pvs
