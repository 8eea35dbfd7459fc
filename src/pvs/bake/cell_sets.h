#pragma once

// What may be seen from one cell.

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "src/pvs/bake/bake_scene.h"
#include "src/pvs/bake/samples.h"

namespace sightline::pvs {

struct CellSets {
  Runs whole;  // seen from anywhere in the cell
  std::optional<CellPlane> plane;
  Runs front, back;  // with a plane: seen from before it, from behind it
};

// That count for the budget: of the side that sees more. Who is between the sides is not there for long.
std::uint64_t trianglesOf(const BakeScene& scene, const CellSets& sets);

// Objects as a bit each, for uniting many runs.
class ObjectMask {
 public:
  // Of so many objects; to begin with none.
  void reset(std::uint32_t count);
  // The same; to begin with all but those of the runs.
  void resetWithout(std::span<const ObjectRun> runs, std::uint32_t count);
  void add(std::span<const ObjectRun> runs);
  bool contains(std::uint32_t position) const { return (words_[position / 64] >> position % 64 & 1) != 0; }
  // out: what is not in it.
  void complement(Runs& out) const;

 private:
  void addRun(const ObjectRun& run);

  std::uint32_t count_ = 0;
  std::vector<std::uint64_t> words_;
};

class CellBaker {
 public:
  explicit CellBaker(const BakeScene& scene);

  // search_distance: occluders that meet the cell, grown by so much on all sides, count.
  CellSets seenFrom(const OctreeCell& cell, double search_distance);
  // The same with a greater distance, from sets with a smaller one.
  void lookFarther(const OctreeCell& cell, double searched, double search_distance, CellSets& sets);
  // Whether cells within this one are likely to see clearly less: a corner or centre of it, or a centre of
  // its children, does, with all occluders that are of use to the smallest cells.
  bool dividingHelps(const OctreeCell& cell, double search_distance, const CellSets& sets);
  // Whether the cell is larger than occluders near it are of use to: then points within are no fair sample of
  // what smaller cells see.
  bool tooLargeForItsOccluders(const OctreeCell& cell) const;
  // Whether a larger search box holds nothing new.
  bool searchedAll(const OctreeCell& cell, double search_distance) const;

  // Between cells: keeps memory within its limit.
  void forgetOldest() { samples_.forgetOldest(); }
  const BakeStats& stats() const { return samples_.stats(); }

 private:
  CellBox searchBox(const OctreeCell& cell, double search_distance) const;
  // Those in the search box that are of use to cells of this level; what seems largest from the cell first.
  void chooseOccluders(const OctreeCell& cell, double search_distance, std::uint32_t level);
  // Takes from each set what the chosen occluders hide from its region: the cell, or a side of its plane.
  void removeHidden(const CellBox& box, CellSets& sets);
  void removeHiddenFrom(std::span<const Vec3d> corners, Runs& seen);
  bool intersectOverCorners(std::uint32_t occluder, std::span<Sample* const> corners);
  std::uint64_t trianglesSeenFrom(const Vec3d& eye);

  const BakeScene& scene_;
  SampleStore samples_;
  // Of the cell at hand.
  std::vector<std::uint32_t> chosen_;
  std::vector<std::pair<double, std::uint32_t>> ranked_;
  std::vector<DividingFace> faces_;
  ObjectMask hidden_;
  Runs common_, scratch_;
};

}  // namespace sightline::pvs
