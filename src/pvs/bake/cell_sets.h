#pragma once

// Computes what may be seen from one cell.

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "src/pvs/bake/bake_scene.h"
#include "src/pvs/bake/region_occlusion.h"
#include "src/pvs/bake/samples.h"

namespace sightline::pvs {

struct CellSets {
  Runs whole;  // seen from anywhere in the cell
  std::optional<CellPlane> plane;
  Runs front, back;  // with a plane only: seen from its front, from its back
};

// Triangles compared with the budget: those of the side that sees more. Viewers between the sides do not
// count, as they are there only briefly.
std::uint64_t trianglesOf(const BakeScene& scene, const CellSets& sets);

// One bit per object, to unite many runs fast.
class ObjectMask {
 public:
  // Resizes to `count` objects, none of them set.
  void reset(std::uint32_t count);
  // Resizes to `count` objects, all set except those of the runs.
  void resetWithout(std::span<const ObjectRun> runs, std::uint32_t count);
  void add(std::span<const ObjectRun> runs);
  bool contains(std::uint32_t position) const { return (words_[position / 64] >> position % 64 & 1) != 0; }
  bool containsAll(const ObjectRun& run) const;
  // out: the objects that are not set.
  void complement(Runs& out) const;

 private:
  void addRun(const ObjectRun& run);

  std::uint32_t count_ = 0;
  std::vector<std::uint64_t> words_;
};

class CellBaker {
 public:
  explicit CellBaker(const BakeScene& scene);

  // Sets of the cell. Convex occluders count that intersect the cell grown by search_distance metres on all
  // sides, surfaces wherever they are. seen: from anywhere in the parent, of which the sets are a part; empty
  // if not known.
  CellSets seenFrom(const OctreeCell& cell, double search_distance, const Runs& seen);
  // Updates the sets, computed with the smaller distance `searched`, to the greater search_distance.
  void lookFarther(const OctreeCell& cell, double searched, double search_distance, CellSets& sets);
  // True if cells within this one are likely to see clearly less: if a corner or the centre of the cell, or a
  // centre of one of its children, does, with all occluders that are useful to the smallest cells.
  bool dividingHelps(const OctreeCell& cell, double search_distance, const CellSets& sets);
  // True if the cell is larger than what occluders near it are useful to. Points in it are then no fair
  // sample of what smaller cells see.
  bool tooLargeForItsOccluders(const OctreeCell& cell) const;
  // True if a larger search box would contain no further occluders.
  bool searchedAll(const OctreeCell& cell, double search_distance) const;

  // Discards samples until they fit their limit; called between cells.
  void forgetOldest() { samples_.forgetOldest(); }
  const BakeStats& stats() const { return samples_.stats(); }
  // The last cell is divided. Forgets what hides objects from the sides of its plane: the cells below it have
  // planes of their own, and if they become one cell again, it has theirs.
  void forgetSides();
  // What hid objects since the last call; empty if the settings do not ask for it.
  std::vector<HidingWitness> takeWitnesses() { return std::exchange(witnesses_, {}); }

 private:
  bool fused() const { return scene_.settings.occlusion == BakeOcclusion::kFused; }
  CellBox searchBox(const OctreeCell& cell, double search_distance) const;
  // Fills chosen_ with the occluders in the search box that are useful to cells of this level, those that
  // look largest from the cell first.
  void chooseOccluders(const OctreeCell& cell, double search_distance, std::uint32_t level);
  // Removes from each set what the chosen occluders hide from its region (the cell, or a side of its plane).
  void removeHidden(const CellBox& box, CellSets& sets);
  void removeHiddenFrom(std::span<const Vec3d> corners, WitnessPart part, Runs& seen);
  // Removes from each set what surfaces hide from its region, of what lies in the boxes of the tree.
  void removeFused(const CellBox& box, CellSets& sets);
  void removeFusedFrom(const CellBox& region, WitnessPart part, Runs& seen);
  void removeFusedBelow(std::uint32_t node, const CellBox& region);
  bool hidesObject(const CellBox& region, const Box& bounds, ObjectId object);
  // object: FusedTarget::object
  bool hidesBox(const CellBox& region, const Box& box, std::uint32_t object, const RegionEffort& effort);
  // An estimate of the part of these objects' triangles that a point sees, from lines of sight to some of
  // them.
  double shareSeenFrom(const Vec3d& point, const Runs& seen);
  bool intersectOverCorners(std::uint32_t occluder, std::span<Sample* const> corners);
  std::uint64_t trianglesSeenFrom(const Vec3d& eye);
  // Records, if it is asked for, that these objects are hidden, as far as hidden_ does not hold them yet.
  void recordConvex(std::uint32_t occluder, std::span<const ObjectRun> objects);
  void recordSurfaces(const ObjectRun& objects);
  void record(HidingWitness witness, std::span<const ObjectRun> objects);

  const BakeScene& scene_;
  SampleStore samples_;
  RegionOcclusion surfaces_;
  // Scratch for the current cell.
  std::vector<std::uint32_t> chosen_;
  std::vector<std::pair<double, std::uint32_t>> ranked_;
  std::vector<DividingFace> faces_;
  ObjectMask hidden_;
  Runs common_, scratch_;
  std::vector<HidingWitness> witnesses_;
  std::uint64_t cell_ = 1;  // cellNumber of the current cell
  WitnessPart part_ = WitnessPart::kWhole;
  WitnessKind decided_by_ = WitnessKind::kSurfaces;  // how the last object was found hidden by surfaces
};

}  // namespace sightline::pvs
