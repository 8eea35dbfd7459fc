#pragma once

// The sorts and the searches that a LayerSorter can be made with: the defaults and those of
// sightline::comparison, all of which give the same answers.

#include "sightline/comparison/layer_sorting.h"
#include "sightline/layers/layer_sorter.h"

namespace sightline {

enum class SortChoice { kDepthFirst, kIncremental };
enum class SearchChoice { kScan, kTree };

inline constexpr SortChoice kSortChoices[] = {SortChoice::kDepthFirst, SortChoice::kIncremental};
inline constexpr SearchChoice kSearchChoices[] = {SearchChoice::kScan, SearchChoice::kTree};

inline MakeLayerSort sortOf(SortChoice choice) {
  return choice == SortChoice::kIncremental ? incrementalSort() : MakeLayerSort();
}

inline MakeCandidateSearch searchOf(SearchChoice choice, const ExtentTreeSettings& tree = {}) {
  return choice == SearchChoice::kTree ? extentTree(tree) : MakeCandidateSearch();
}

inline const char* nameOf(SortChoice choice) {
  return choice == SortChoice::kDepthFirst ? "depth first" : "incremental";
}

inline const char* nameOf(SearchChoice choice) {
  return choice == SearchChoice::kScan ? "scan" : "tree";
}

}  // namespace sightline
