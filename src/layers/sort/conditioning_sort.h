#pragma once

// Moves groups forward past farther groups that do not occlude them, so that the order stays near the one by
// distance, which is close to what later frames need.
//
// Based on: Snyder, Lengyel. Visibility Sorting and Compositing for Image-Based Rendering. MSR-TR-97-11,
// 1997, section 7.
// Differs from the paper in: a group moves past groups that do not occlude it (the paper tests whether the
// moving group occludes those that it passes, which it may); the number of tests per frame is limited.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "src/layers/sort/occluder_source.h"

namespace sightline::layers {

class ConditioningSort {
 public:
  // Whether one part may occlude another. Conservative: always true where it does.
  struct MayOcclude {
    bool (*ask)(void* user, std::uint32_t front, std::uint32_t back) = nullptr;
    void* user = nullptr;
  };
  struct Settings {
    std::uint64_t max_tests = 100'000;  // pairs of parts tested, after which groups stay where they are
  };

  // Sorts the groups by their keys, ascending, with a stable insertion sort in which a group stops behind one
  // that may occlude it; then sorts the parts within each group by their own keys. A key that is NaN counts
  // as infinite. A valid order stays valid: no part is occluded by one of a later group. Arcs are not
  // changed.
  // group_keys: one per group, in the given order. part_keys: one per part, by part number.
  // Returns the number of groups that moved forward. Does not allocate after a call of the same size.
  std::uint64_t sort(std::span<const double> group_keys, std::span<const double> part_keys,
                     const MayOcclude& may_occlude, const Settings& settings, GroupedOrder& order);

 private:
  struct Keyed {
    double key;
    std::uint32_t place, item;  // place: index before the sort, which breaks ties
  };

  std::uint64_t moveGroups(const MayOcclude& may_occlude, std::uint64_t tests_left,
                           const GroupedOrder& order);
  void rebuild(GroupedOrder& order);
  void sortParts(std::span<const double> part_keys, GroupedOrder& order);

  std::vector<Keyed> groups_, members_;
  std::vector<std::uint32_t> parts_, first_of_;  // copy of the order before the sort
};

}  // namespace sightline::layers
