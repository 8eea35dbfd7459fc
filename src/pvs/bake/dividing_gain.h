#pragma once

// Whether it helps to divide a cell.

#include <cstdint>

#include "src/pvs/bake/bake_counts.h"
#include "src/pvs/bake/bake_scene.h"
#include "src/pvs/bake/cell_occluders.h"
#include "src/pvs/bake/convex/convex_search.h"
#include "src/pvs/bake/convex/samples.h"
#include "src/pvs/bake/object_mask.h"
#include "src/pvs/bake/seen_sets.h"
#include "src/pvs/bake/surfaces/region_occlusion.h"
#include "src/pvs/bake/update/cell_recall.h"

namespace sightline::pvs {

// Asks what is seen from some points of a cell. Use by one thread at a time.
class DividingGain {
 public:
  // What answers the questions: it must outlive this, and may be asked by others in between.
  DividingGain(const BakeScene& scene, CellRecall& recall, ConvexSearch& search, SampleStore& samples,
               RegionOcclusion& surfaces)
      : scene_(scene),
        recall_(recall),
        search_(search),
        samples_(samples),
        surfaces_(surfaces),
        occluders_(scene) {}

  // True if cells within this one are likely to see clearly less than its sets: if a corner or the centre of
  // the cell, or a centre of one of its children, does, with all occluders that are useful to the smallest
  // cells.
  bool helps(const OctreeCell& cell, double search_distance, const CellSets& sets);

  const BakeCounts& counts() const { return counts_; }  // of all calls

 private:
  // An estimate of the part of these objects' triangles that a point sees, from lines of sight to some of
  // them.
  double shareSeenFrom(const Vec3d& point, const Runs& seen);
  std::uint64_t trianglesSeenFrom(const Vec3d& eye);
  // Whether trianglesSeenFrom is less than this, by what an earlier bake found or by asking.
  bool seesFewer(const Vec3d& eye, double triangles);

  const BakeScene& scene_;
  CellRecall& recall_;
  ConvexSearch& search_;
  SampleStore& samples_;
  RegionOcclusion& surfaces_;
  CellOccluders occluders_;
  BakeCounts counts_;
  ObjectMask hidden_;  // scratch for one point
  Runs seen_;
};

}  // namespace sightline::pvs
