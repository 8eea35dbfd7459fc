#pragma once

// Draws whole surfaces into a depth buffer, by the winding of their boundaries. See docs/conservative.md,
// "Surfaces".

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/occluders/surface_set.h"
#include "sightline/occlusion/rasteriser.h"
#include "src/base/sparse_array.h"
#include "src/occlusion/surfaces/chain_edges.h"
#include "src/occlusion/surfaces/surface_memory.h"
#include "src/occlusion/surfaces/surface_view.h"
#include "src/occlusion/surfaces/winding_map.h"
#include "src/scene/pixel_view.h"

namespace sightline::occlusion {

class SurfaceRaster {
 public:
  // Makes room for a set, so that the first draw() of it need not.
  void reserve(const SurfaceSet& set, SurfaceMemory& memory);
  // map: of the view's buffer, aimed at the drawing's targets. view: in the space of the set.
  void draw(const SurfaceSet& set, const scene::PixelView& view, std::span<const ObjectId> candidates,
            const SurfaceDrawing& drawing, SurfaceMemory& memory, WindingMap& map,
            const ParallelFor& parallel_for);
  const SurfaceStats& stats() const { return stats_; }

 private:
  // How often clusters of a group run along a chain, less how often they run back. It is the sum of the
  // group that looked at the chain last; for another group it counts as 0.
  struct ChainSum {
    std::uint32_t group = 0;
    std::int32_t value = 0;
  };

  // A group that waits for being drawn.
  struct Group {
    std::uint32_t first_chain = 0, chain_count = 0;  // into boundary_
    std::uint32_t first_depth = 0, depth_count = 0;  // into depths_
    std::uint32_t edges = 0;
    PixelRectangle rectangle;
    bool flat = false;
    double distance = 0.0;  // from the eye, about, metres
    std::uint32_t part = 0;
    SurfaceMemory::Rest* rest = nullptr;  // its own
  };

  void start(const SurfaceSet& set);
  bool rests(const SurfaceMemory::Rest& rest) const;
  bool leavesOut(const SurfaceMemory::Rest& rest) const;
  bool pays(std::uint32_t pixels, std::uint32_t edges) const;
  void listUseful();
  const SurfaceMemory::Facing& facingOf(std::uint32_t patch);
  void addPart(const PartImage& part, std::uint32_t pixels);
  void listPatches(const SurfacePart& part, bool together);
  std::uint64_t countWanted();
  void addPatch(const PatchImage& patch, SurfaceMemory::Rest& rest);
  void addTogether(std::span<const ClusterImage> clusters, std::span<const PatchImage> patches,
                   const PixelRectangle& rectangle, SurfaceMemory::Rest& rest);
  void beginGroup();
  void endGroup(const PixelRectangle& rectangle, bool flat, SurfaceMemory::Rest& rest);
  void addBoundary(std::span<const ClusterImage> clusters, std::span<const PatchImage> patches);
  void addToSum(std::uint32_t chain, std::int32_t value);
  void addEdges(std::uint32_t chain, std::int32_t value) { chains_.add(chain, value * winding_); }
  void addCuts(const ClusterImage& image);
  bool withinBudget();
  void drawGroups();
  void account(const Group& group, const WindingGain& gain, std::uint64_t work);
  void rest(const Group& group);

  const SurfaceSet* set_ = nullptr;
  SurfaceMemory* memory_ = nullptr;  // of the set
  SurfaceDrawing drawing_;
  const ParallelFor* parallel_for_ = nullptr;  // of the view
  std::int32_t winding_ = 1;                   // of a front in this view; -1 in one that mirrors
  SurfaceView view_;
  ChainEdges chains_;
  WindingMap* map_ = nullptr;  // of the view
  SurfaceStats stats_;
  // What was drawn in this view, and about what waits for it, as SurfaceLimits::budget counts it.
  std::uint64_t work_ = 0, waiting_work_ = 0;
  base::SparseArray<ChainSum> sums_;  // by chain, of the largest set that was drawn
  std::uint32_t group_ = 0;           // number of the last group
  // Groups that wait for being drawn, their boundaries, and how far away they are:
  std::vector<Group> groups_;
  std::vector<BoundaryChain> boundary_;
  std::vector<PartDepth> depths_;
  // Scratch for one drawGroups():
  std::vector<WindingGroup> drawn_;
  std::vector<WindingGain> gains_;
  std::vector<std::uint32_t> summed_;  // scratch for one addBoundary(): chains
  // Scratch for one addPart(): patches that do not face away, those that may be seen, in how many pixels each
  // of these may gain something, and those that are drawn as a whole.
  std::vector<ShownPatch> sides_;
  std::vector<PatchImage> shown_, patches_;
  std::vector<std::uint32_t> wanted_;
  std::uint32_t rested_ = 0;  // groups that began to rest in this view
  // addPart() sets these to the number of its part, and to what Group::distance is for it.
  std::uint32_t part_ = 0;
  double part_distance_ = 0.0;
  std::vector<std::uint32_t> useful_parts_;  // scratch for one listUseful()
};

}  // namespace sightline::occlusion
