#pragma once

// Baking: for every cell of space, what may be seen from anywhere in it. Once a scene, in parts that any
// thread or machine may bake.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sightline/base/parallel_for.h"
#include "sightline/base/result.h"
#include "sightline/occluders/occluder_set.h"
#include "sightline/pvs/format/baked_visibility.h"
#include "sightline/scene/scene.h"

namespace sightline {

struct BakeSettings {
  std::uint64_t triangle_budget = 0;  // a cell with so few is not divided (the target frame rate)
  std::uint32_t max_depth = 6;        // of the octree (the memory), at most kMaxOctreeDepth
  // The farthest from a viewer's eye that its near plane clips, metres (nearDistance): what occluders hide
  // only from closer does not count. Viewers with a greater one get everything as their set.
  double near_distance = 0.25;
  // Viewers are in this box, scene space; an empty one: in the bounds of the scene.
  Box region{};
  // Occluders are looked for within so many metres of a viewpoint, at first; 0: chosen. Doubled where that
  // helps.
  double search_distance = 0.0;
  // An occluder is of use to a cell when its area is so many times that of the cell's smallest face, or its
  // volume so many times the cell's.
  double occluder_size = 1.0;
  // Dividing helps where some point, of the cell's corners and centre and its children's centres, sees less
  // than the cell by this part of the cell's triangles.
  double similarity = 0.1;
  double least_gain = 0.02;  // doubling the search box helped when it hid this part of the triangles
  // Siblings are merged when all together see at most this part more than each.
  double merge_tolerance = 0.05;
  // Of a worker, between cells; what is forgotten is computed again.
  std::size_t sample_bytes = 256u << 20;
};

// One part's cells as plain bytes, the same wherever it was baked.
using BakedPart = std::vector<std::byte>;

struct PartSummary {
  std::uint32_t leaves = 0;
  double mean_triangles = 0.0;  // of their sets
};

struct BakeStats {
  std::uint64_t samples = 0;          // viewpoints from which something was computed
  std::uint64_t shadows = 0;          // occluders seen from a viewpoint
  std::uint64_t forgotten = 0;        // samples, for want of memory
  std::size_t most_sample_bytes = 0;  // that samples took at any time
  friend bool operator==(const BakeStats&, const BakeStats&) = default;
};

// The plan of a bake: what all of its parts share. Does not change; any number of threads may bake parts.
class Bake {
 public:
  // Computes the top of the octree, down to the parts. scene, occluders: need not outlive it. An error where
  // settings are out of range, where there is no region and no object with a finite box, and where an
  // occluder belongs to no object of the scene. occluders: all that are to be considered; area_fraction = 1
  // leaves none out.
  static Result<Bake> plan(const SceneView& scene, const OccluderSet& occluders,
                           const BakeSettings& settings = {});

  std::uint32_t partCount() const;
  std::uint32_t occluderCount() const;  // potential occluders: convex bodies and convex polygons
  // Says which plan it is: parts and checkpoints of one plan are of no use to another.
  std::uint64_t hash() const;

  // Holds the samples of the parts that it bakes, one after the other. For one thread at a time.
  class Worker {
   public:
    explicit Worker(const Bake& bake);  // keeps its plan alive
    ~Worker();
    Worker(Worker&&) noexcept;
    // part < partCount(). Depends on nothing but the plan and the part.
    BakedPart bake(std::uint32_t part);
    const BakeStats& stats() const;

   private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
  };

  static PartSummary summaryOf(std::span<const std::byte> part);

  // parts: all, by number. The same for the same plan, whoever baked the parts. An error where bytes are not
  // of this plan.
  Result<BakedVisibility> assemble(std::span<const BakedPart> parts) const;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

// All of it in one call, in the threads of parallel_for.
Result<BakedVisibility> bakeVisibility(const SceneView& scene, const OccluderSet& occluders,
                                       const BakeSettings& settings = {},
                                       const ParallelFor& parallel_for = serialFor);

}  // namespace sightline
