#pragma once

// The scene data of a bake: objects, occluders, and the trees that find them. Immutable.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/hierarchy/box_tree.h"
#include "sightline/pvs/bake/bake.h"
#include "src/pvs/bake/cell_region.h"
#include "src/pvs/bake/convex/cone_search.h"
#include "src/pvs/bake/convex/convex_occluder.h"
#include "src/pvs/bake/convex/shadow_tree.h"
#include "src/pvs/bake/doors/door_groups.h"
#include "src/pvs/bake/runs.h"
#include "src/pvs/bake/surfaces/panels.h"

namespace sightline::pvs {

// Version of the bake method; increase it whenever the same input would give other cells, or the same
// question another answer.
inline constexpr std::uint32_t kBakeVersion = 17;

// Whether surfaces are to hide as much as they can, in a longer time: with small panels, and asked again
// without what keeps them from it. So it is where narrowing or dividing is asked for.
inline bool isThorough(const BakeSettings& settings) {
  return settings.narrowings > 0 || settings.divisions > 0;
}

struct BakeScene {
  // settings: must be valid, with at least one box of viewers.
  BakeScene(const SceneView& scene, const OccluderSet& set, const BakeSettings& settings,
            const ParallelFor& parallel_for);
  BakeScene(const BakeScene&) = delete;
  BakeScene& operator=(const BakeScene&) = delete;

  BakeSettings settings;  // including the chosen max_depth
  DoorGroups doors;
  Runs door_runs;          // all doors
  CellBox region;          // around all boxes of viewers
  CellBox root;            // a cube
  double reach = 0.0;      // maximum distance from any viewer to any box, metres
  BoxTree boxes;           // of the objects; sets are expressed in terms of its nodes
  double magnitude = 0.0;  // bound of the coordinates of all cells and all objects that may be hidden, metres
  ShadowTree shadow_tree;
  TriangleCounts triangles;
  std::vector<std::uint32_t> position_of;           // index into BoxTree::objects, by object
  ConvexOccluders occluders;                        // those of doors too, which all functions below leave out
  std::vector<std::uint32_t> position_of_occluder;  // that of its object, by occluder
  Panels panels;  // while all doors are open; none if only convex occluders hide
  // By group of doors: the panels while its doors are closed and all others are open. None if only convex
  // occluders hide.
  std::vector<Panels> closed_panels;
  Box frame;                 // around the root and all panels
  ObjectBoxes object_boxes;  // none if only convex occluders hide
  OccluderCounts counts;
  double side_margin = 0.0;  // sideMargin of the root, metres
  double diagonal = 0.0;     // diagonal of the region and all objects, metres

  // Rounding moves a line of sight by far less than this, metres.
  double lineMargin() const { return 0x1p-36 * (magnitude + reach); }
  // The convex occluders of a door, ascending.
  std::span<const std::uint32_t> occludersOfDoor(ObjectId door) const;
  // The leaf of an object, by its place in BoxTree::objects.
  const BoxNode& leafOf(std::uint32_t position) const { return boxes.nodes[leaf_of_[position]]; }
  CellBox boxOf(const OctreeCell& cell) const {
    return {cellMin(root.min, root.max, cell), cellMax(root.min, root.max, cell)};
  }
  // True if viewers can be in the box.
  bool holdsViewers(const CellBox& box) const;
  // Where in the cell viewers can be; the cell must hold some. All of it with BakeSettings::whole_cells.
  ViewerBounds viewersIn(const OctreeCell& cell) const;
  // The box of these: the sets of the cell are those of viewers anywhere in it. It lies within the region of
  // the cell's parent.
  CellBox regionOf(const OctreeCell& cell) const;
  bool hasManyObjects() const { return position_of.size() > BakeSettings::kManyObjects; }
  // BakeSettings::sample_bytes, or what is chosen if it is not given.
  std::size_t sampleBytes() const;
  // Any cell down to this level may be divided; below it, only cells near occluders.
  std::uint32_t baseDepth() const { return base_depth_; }
  // True if the cell's depth allows dividing it.
  bool mayDivide(const OctreeCell& cell) const;
  // How many leaves with viewers come of the cell if all cells are divided that may be; counted up to `most`.
  std::uint64_t mostLeaves(const OctreeCell& cell, std::uint64_t most) const;
  // Appends, in ascending order, the occluders that intersect the box and are useful to cells of this level.
  void findOccluders(const CellBox& box, std::uint32_t level, std::vector<std::uint32_t>& found) const;
  // Those that are useful to cells of this level, for searches along lines of sight.
  const ConeTree& occludersInCones(std::uint32_t level) const { return levels_[level].cones; }
  // Lines of sight from the point to the box.
  Cone coneTo(const CellBox& box, const Vec3d& point) const {
    return {point, box, lineMargin(), magnitude + reach};
  }
  // Lines of sight from anywhere in one box to the other.
  Cone hullOf(const CellBox& from, const CellBox& to) const {
    return {from, to, lineMargin(), magnitude + reach};
  }
  // True if the occluder is useful to cells of this level.
  bool isOfUseAt(std::uint32_t level, std::uint32_t occluder) const {
    return (levels_of_use_[occluder] >> level & 1u) != 0;
  }
  // Appends the faces that intersect the box.
  void findFaces(const CellBox& box, std::vector<DividingFace>& found) const;
  // True if some occluder that intersects the box is too small for cells of this level but useful to smaller
  // ones.
  bool holdsSmallOccluders(const CellBox& box, std::uint32_t level) const;
  // True if every occluder that is useful to any cell intersects the box.
  bool holdsAllOccluders(const CellBox& box) const;

 private:
  std::vector<std::vector<std::uint32_t>> door_occluders_;  // by index into doors.all
  BoxTree viewer_tree_;
  std::vector<std::uint32_t> leaf_of_;  // into BoxTree::nodes
  // Below base_depth_, down to settings.max_depth, only cells that intersect one of these boxes are divided.
  std::uint32_t base_depth_ = 0;
  BoxTree reach_tree_;
  std::vector<ConvexEdge> face_edges_;
  std::vector<DividingFace> faces_;  // of all occluders, including bodies
  BoxTree face_tree_;
  // The occluders that are large enough for the cells of one level.
  struct LevelOccluders {
    std::vector<std::uint32_t> occluders;  // ascending
    BoxTree tree;                          // its objects are indices into `occluders`
    ConeTree cones{};                      // of the same boxes, by number of the occluder
  };
  std::size_t indexOf(ObjectId door) const;  // into doors.all
  void numberObjects();
  void numberOccluders();
  void chooseDepth();
  void countOccluders();
  BoxTree reachOfOccluders(std::uint32_t level) const;
  bool ofUse(const ConvexOccluder& occluder, std::uint32_t level) const;
  LevelOccluders occludersFor(std::uint32_t level) const;
  void gatherLevels(const OccluderSet& set, const ParallelFor& parallel_for);
  void gatherFaces(const OccluderSet& set);
  std::vector<LevelOccluders> levels_;
  static_assert(kMaxOctreeDepth < 32);
  std::vector<std::uint32_t> levels_of_use_;  // by occluder: bits of the levels
};

}  // namespace sightline::pvs
