#pragma once

// What a bake knows of its scene: objects, occluders, and trees to find them by. Does not change.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/hierarchy/box_tree.h"
#include "sightline/pvs/bake/bake.h"
#include "src/pvs/bake/cell_region.h"
#include "src/pvs/bake/convex_occluder.h"
#include "src/pvs/bake/runs.h"
#include "src/pvs/bake/shadow_tree.h"

namespace sightline::pvs {

struct BakeScene {
  // settings: usable ones. region: where viewers are.
  BakeScene(const SceneView& scene, const OccluderSet& set, const BakeSettings& settings,
            const CellBox& region);
  BakeScene(const BakeScene&) = delete;
  BakeScene& operator=(const BakeScene&) = delete;

  BakeSettings settings;  // max_depth: chosen, where it was to be
  CellBox region;
  CellBox root;   // a cube
  BoxTree boxes;  // of the objects; sets are made of its nodes
  ShadowTree shadow_tree;
  TriangleCounts triangles;
  std::vector<std::uint32_t> position_of;  // by object, into BoxTree::objects
  ConvexOccluders occluders;
  OccluderCounts counts;
  double side_margin = 0.0;  // metres, of the root
  double diagonal = 0.0;     // metres, of the region and all objects
  double reach = 0.0;        // metres, from any viewer to any box

  CellBox boxOf(const OctreeCell& cell) const {
    return {cellMin(root.min, root.max, cell), cellMax(root.min, root.max, cell)};
  }
  // All cells down to this level may be divided; below it, only those near occluders.
  std::uint32_t baseDepth() const { return base_depth_; }
  // Whether the depth lets the cell be divided.
  bool mayDivide(const OctreeCell& cell) const;
  // Appends, ascending, the occluders that meet the box and are of use to cells of this level.
  void findOccluders(const CellBox& box, std::uint32_t level, std::vector<std::uint32_t>& found) const;
  // Appends the faces that meet the box.
  void findFaces(const CellBox& box, std::vector<DividingFace>& found) const;
  // Whether some occluder that meets the box is too small for cells of this level, and of use to smaller
  // ones.
  bool holdsSmallOccluders(const CellBox& box, std::uint32_t level) const;
  // Whether no occluder is of use to any cell and outside the box.
  bool holdsAllOccluders(const CellBox& box) const;

 private:
  // Deeper than the base, down to settings.max_depth, only cells that meet one of the boxes are divided.
  std::uint32_t base_depth_ = 0;
  BoxTree reach_tree_;
  std::vector<ConvexEdge> face_edges_;
  std::vector<DividingFace> faces_;  // of all occluders, also of those of bodies
  BoxTree face_tree_;
  // Of the occluders that are of use to cells of one level: large enough for their size.
  struct LevelOccluders {
    std::vector<std::uint32_t> occluders;  // ascending
    BoxTree tree;                          // its objects are numbers into `occluders`
  };
  void chooseDepth();
  void countOccluders();
  BoxTree reachOfOccluders(std::uint32_t level) const;
  bool ofUse(const ConvexOccluder& occluder, std::uint32_t level) const;
  LevelOccluders occludersFor(std::uint32_t level) const;
  std::vector<LevelOccluders> levels_;
};

}  // namespace sightline::pvs
