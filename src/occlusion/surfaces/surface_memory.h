#pragma once

// What is known of a set of surfaces from the views in which it was drawn.

#include <cstdint>
#include <memory>
#include <vector>

#include "sightline/occluders/surface_set.h"
#include "sightline/occlusion/rasteriser.h"
#include "src/base/sparse_array.h"

namespace sightline::occlusion {

struct SurfaceMemory {
  // The side of a patch that the eye is on, as it was found in a view.
  struct Facing {
    std::uint32_t since = 0;  // number of the view
    bool away = false;     // a back shows, of which nothing is drawn, so that the patch need not be looked at
    std::int8_t side = 0;  // as in PatchSide
    double travel = 0.0;   // it is the same at least until `travel` is that much
  };

  // What is not worth its cost is left out for some views; what paid is drawn first in the next one.
  struct Rest {
    std::uint32_t since = 0;                  // number of the view in which that was found
    std::uint32_t length = 0;                 // views after that one, at most
    double travel = 0.0;                      // where a long rest ends: what `travel` is then
    std::uint32_t drawn_in = 0, paid_in = 0;  // numbers of the last view in which it was drawn, and paid
  };

  // A part of which something paid in a view.
  struct UsefulPart {
    std::uint32_t part = 0;
    std::uint64_t gain = 0;  // of all that paid
  };

  // Makes room for what is kept of a set. Of smaller sets nothing is kept any more.
  void reserve(const SurfaceSet& set);
  // The set is drawn in a view. If it is not the set of the last one, nothing is known of it. step: from the
  // view in which it was drawn last.
  void beginView(const SurfaceSet& set, const Vec3d& eye_of_view, ViewStep step);

  SurfaceSetNumber set_number;    // of the set
  std::uint64_t buffer_view = 0;  // number of the last view of the buffer in which it was drawn
  // These have a place for each item of the set, or of the largest one for which this was used.
  base::SparseArray<Facing> facings;                // by patch
  base::SparseArray<Rest> patch_rests, part_rests;  // by patch and by part
  std::uint32_t view_number = 0;
  std::uint32_t first_view = 0;    // number of the first one since a jump
  std::uint32_t first_of_set = 0;  // number of the first one since which the same set is drawn
  Vec3d eye;                       // of the last view
  double travel = 0.0;             // of the eye, from view to view of the set, or more; metres
  // Parts of which something paid in this view and in the one before; and where a part is in the first list,
  // plus 1, or 0.
  std::vector<UsefulPart> useful, useful_before;
  base::SparseArray<std::uint32_t> place_in_useful;
};

// What is known of several sets. Where there are more than so many, what is known of the one that was drawn
// least recently is given up, unless that was in this view of the buffer or in the last one: sets that are
// drawn in turn would take each other's places, and none would have one when it is drawn again. All that have
// no place share one, which remembers the last of them.
class SurfaceMemories {
 public:
  static constexpr std::size_t kMostSets = 256;

  explicit SurfaceMemories(std::size_t most = kMostSets) : most_(most) {}

  // buffer_view: number of the view of the buffer. What is returned holds until the next call.
  SurfaceMemory& of(const SurfaceSet& set, std::uint64_t buffer_view);

 private:
  struct Known {
    SurfaceSetNumber number;
    std::unique_ptr<SurfaceMemory> memory;
  };

  std::size_t most_;
  std::vector<Known> sets_;
  SurfaceMemory shared_;
};

}  // namespace sightline::occlusion
