#pragma once

// The sort and the search of Snyder and Lengyel's paper, for comparison with the defaults of LayerSorter.
//
// Based on: John Snyder, Jed Lengyel. Visibility Sorting and Compositing for Image-Based Rendering.
// Microsoft Research MSR-TR-97-11, 1997, sections 4 and 5.2.

#include <cstdint>

#include "sightline/layers/layer_sorter.h"

namespace sightline {

// For LayerSettings::sort: puts each part behind its furthest occluder until none is left, and finds cycles
// by marks. The groups are those of the default; the time can be quadratic. Source: section 4.
MakeLayerSort incrementalSort();

struct ExtentTreeSettings {
  std::uint32_t min_gain = 10;      // parts by which a division must shorten the longer child
  std::uint32_t rebuild_after = 0;  // frames after which a new tree is begun beside the old one; 0: never
  // A new tree is also begun when a query compares this many times as many parts as in the first frames after
  // the build; 0: never.
  double rebuild_imbalance = 1.5;
  std::uint32_t rebuild_steps = 32;       // nodes built per frame while a new tree is in the making
  std::uint32_t tree_axes = 0xffffffffu;  // bit a: nodes may divide along axis a; leaves test all axes
};

// For LayerSettings::search: a kd-tree over the extents, which follows the parts from frame to frame. The
// candidates are those of the default, the scan. Source: section 5.2.
MakeCandidateSearch extentTree(const ExtentTreeSettings& settings = {});

}  // namespace sightline
