#pragma once

// Draws whole surfaces into a depth buffer, by the winding of their boundaries. See docs/conservative.md,
// "Surfaces".

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sightline/occluders/surface_set.h"
#include "sightline/occlusion/rasteriser.h"
#include "src/occlusion/chain_points.h"
#include "src/occlusion/surface_view.h"
#include "src/occlusion/winding_map.h"
#include "src/scene/pixel_view.h"

namespace sightline::occlusion {

class SurfaceRaster {
 public:
  void draw(const SurfaceSet& set, const PixelView& view, std::span<const ObjectId> candidates,
            const SurfaceDrawing& drawing, const DepthTarget& target);
  const SurfaceStats& stats() const { return stats_; }

 private:
  // The group that a cluster was in most recently.
  struct Membership {
    std::uint32_t group = 0;
    std::int32_t sign = 0;  // 1, or -1 with its other side
  };

  // What is not worth its cost is left out for some views.
  struct Rest {
    std::uint32_t since = 0;   // number of the view in which that was found
    std::uint32_t length = 0;  // views after that one
  };

  void start(const SurfaceSet& set, ViewStep step);
  bool rests(const Rest& rest) const;
  bool pays(const PixelRectangle& rectangle, std::uint32_t edges) const;
  void drawPart(const PartImage& part);
  void drawPatch(const PatchImage& patch, Rest& rest);
  void drawTogether(std::span<const ClusterImage> clusters, std::span<const PatchImage> patches,
                    const PixelRectangle& rectangle, Rest& rest);
  void beginGroup(const PixelRectangle& rectangle);
  void addMember(std::uint32_t cluster, std::int32_t sign) { members_[cluster] = {group_, sign}; }
  void addBoundary(std::span<const ClusterImage> clusters);
  void addChain(std::uint32_t chain);
  void addEdges(std::uint32_t chain, std::int32_t value);
  void addCuts(const ClusterImage& image);
  void account(std::uint32_t nearer, Rest& rest);
  std::uint64_t work() const;  // in this view, as SurfaceDrawing::budget counts it

  const SurfaceSet* set_ = nullptr;
  std::array<std::size_t, 4> sizes_{};  // of the set, by which one made anew in the same place is noticed
  SurfaceDrawing drawing_;
  std::int32_t winding_ = 1;  // of a front in this view; -1 in one that mirrors
  SurfaceView view_;
  ChainPoints points_;
  WindingMap map_;
  SurfaceStats stats_;
  std::uint64_t work_before_ = 0;  // before the group that is drawn
  // Of the largest set that was drawn:
  std::vector<Membership> members_;             // by cluster
  std::vector<std::uint32_t> last_groups_;      // by chain: the group that it was drawn in most recently
  std::uint32_t group_ = 0;                     // number of the last group
  std::vector<PatchImage> patches_;             // of a part: those that are drawn as a whole
  std::vector<Rest> patch_rests_, part_rests_;  // by patch and by part
  std::vector<std::uint32_t> drawn_in_;         // by part: number of the view in which it was drawn last
  std::uint32_t view_number_ = 0;
  std::uint32_t first_view_ = 0;  // number of the first one since a jump
};

}  // namespace sightline::occlusion
