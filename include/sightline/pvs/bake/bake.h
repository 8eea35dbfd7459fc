#pragma once

// Baking: for every cell of space, what may be seen from anywhere in it. Once a scene, in parts that any
// thread or machine may bake.

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "sightline/base/parallel_for.h"
#include "sightline/base/progress.h"
#include "sightline/base/result.h"
#include "sightline/occluders/occluder_set.h"
#include "sightline/pvs/format/baked_visibility.h"
#include "sightline/scene/scene.h"

namespace sightline {

struct BakeSettings {
  std::uint64_t triangle_budget = 0;  // a cell with so few is not divided (the target frame rate)
  // How often a cell of the octree is halved, which decides on memory: at most kMaxOctreeDepth, or
  // kChooseDepth for one that suits the sizes of the region and of the occluders.
  static constexpr std::uint32_t kChooseDepth = 0xffffffffu;
  std::uint32_t max_depth = kChooseDepth;
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
  double min_gain = 0.02;  // doubling the search box helped when it hid this part of the triangles
  // Siblings are merged when all together see at most this part more than each.
  double merge_tolerance = 0.05;
  // Of a worker, between cells; what is forgotten is computed again.
  std::size_t sample_bytes = 256u << 20;
};

// A cell of the octree that one thread bakes, or divides into eight such parts: which parts there are comes
// out as the bake goes.
struct PartTask {
  std::uint64_t id = 1;          // 1: the root; 8 * id + i: child number i of it
  double search_distance = 0.0;  // metres, from the part that it is a child of
  friend bool operator==(const PartTask&, const PartTask&) = default;
};

// What became of one part, as plain bytes, the same wherever it was baked.
using BakedPart = std::vector<std::byte>;
using BakedParts = std::map<std::uint64_t, BakedPart>;  // by PartTask::id

struct PartSummary {
  std::uint32_t leaves = 0;     // 0: it was divided into parts
  double mean_triangles = 0.0;  // of the leaves' sets
  double share = 0.0;           // of the viewers' region that the leaves cover, 0 to 1
};

struct BakeStats {
  std::uint64_t samples = 0;         // viewpoints from which something was computed
  std::uint64_t shadows = 0;         // occluders seen from a viewpoint
  std::uint64_t forgotten = 0;       // samples, for want of memory
  std::size_t max_sample_bytes = 0;  // that samples took at any time
  friend bool operator==(const BakeStats&, const BakeStats&) = default;
};

void add(BakeStats& sum, const BakeStats& stats);  // of several workers together

// Potential occluders: convex bodies and convex polygons.
struct OccluderCounts {
  std::uint32_t all = 0;
  std::uint32_t inner = 0;    // that are not the region's floor, ceiling or outer wall
  std::uint32_t of_use = 0;   // of those, large enough for the smallest cells
  double largest_area = 0.0;  // of those, square metres of the largest face
};

// The plan of a bake: what all of its parts share. Does not change; any number of threads may bake parts.
//
//   std::vector<PartTask> open{bake.firstPart()};   // until it is empty: take one, bake it, add partsBelow
//   BakedParts parts;                               // then assemble
class Bake {
 public:
  // scene, occluders: need not outlive it. An error where settings are out of range, where there is no region
  // and no object with a finite box, and where an occluder belongs to no object of the scene. occluders: all
  // that are to be considered; area_fraction = 1 leaves none out.
  static Result<Bake> plan(const SceneView& scene, const OccluderSet& occluders,
                           const BakeSettings& settings = {});

  const BakeSettings& settings() const;  // with the depth that was chosen
  // Down to this level any cell may be divided; below it, down to settings().max_depth, only those near
  // occluders.
  std::uint32_t baseDepth() const;
  const OccluderCounts& occluders() const;
  // Says which plan it is: parts and checkpoints of one plan are of no use to another.
  std::uint64_t hash() const;

  PartTask firstPart() const;
  // The parts that a baked one was divided into: eight or none.
  std::vector<PartTask> partsBelow(std::span<const std::byte> part) const;
  PartSummary summaryOf(std::span<const std::byte> part) const;
  // Whether these bytes say that they are this part of this plan.
  bool isPart(std::uint64_t id, std::span<const std::byte> part) const;

  // Holds the samples of the parts that it bakes, one after the other. For one thread at a time.
  class Worker {
   public:
    explicit Worker(const Bake& bake);  // keeps its plan alive
    ~Worker();
    Worker(Worker&&) noexcept;
    // part: the first one, or one of partsBelow. Depends on nothing but the plan and the part.
    BakedPart bake(const PartTask& part);
    const BakeStats& stats() const;

   private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
  };

  // All parts, in the threads of parallel_for. stats: of all workers, if asked for.
  BakedParts bakeAll(const ParallelFor& parallel_for = serialFor, const Progress& progress = {},
                     BakeStats* stats = nullptr) const;

  // parts: all. The same for the same plan, whoever baked the parts. An error where one is missing, or bytes
  // are not of this plan.
  Result<BakedVisibility> assemble(const BakedParts& parts) const;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

// All of it in one call, in the threads of parallel_for.
Result<BakedVisibility> bakeVisibility(const SceneView& scene, const OccluderSet& occluders,
                                       const BakeSettings& settings = {},
                                       const ParallelFor& parallel_for = serialFor);

}  // namespace sightline
