#pragma once

// Brings groups to the front of others that they need not be behind, so that the order stays near the one by
// distance, which later frames need.
//
// Based on: Snyder, Lengyel. Visibility Sorting and Compositing for Image-Based Rendering. MSR-TR-97-11,
// 1997, section 7.
// Differs from the paper in: a group moves only past groups that do not occlude it (the paper asks of those
// passed whether the moving one occludes them, which it may); the tests of a frame are
// limited.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "src/layers/sort/occluder_source.h"

namespace sightline::layers {

class ConditioningSort {
 public:
  // Whether one part may occlude another: true where it does; may be true where it does not.
  struct MayOcclude {
    bool (*ask)(void* user, std::uint32_t front, std::uint32_t back) = nullptr;
    void* user = nullptr;
  };
  struct Settings {
    std::uint64_t max_tests =
        100'000;  // pairs of parts that are asked about; then groups stay where they are
  };

  // Stable insertion sort of the groups by their keys, in which a group stops behind one that may occlude it;
  // then stable sort of the parts of each group by theirs, whoever occludes whom. Small keys come first; keys
  // that are not numbers count as infinite. A valid order stays valid: no part is occluded by one of a later
  // group. The arcs stay as they are. group_keys: one a group, in the order's order as it is before.
  // part_keys: by part. Returns how many groups moved to the front. No allocation after calls as large.
  std::uint64_t sort(std::span<const double> group_keys, std::span<const double> part_keys,
                     const MayOcclude& may_occlude, const Settings& settings, GroupedOrder& order);

 private:
  struct Keyed {
    double key;
    std::uint32_t place, item;  // place: before; breaks ties
  };

  std::uint64_t moveGroups(const MayOcclude& may_occlude, std::uint64_t tests_left,
                           const GroupedOrder& order);
  void rebuild(GroupedOrder& order);
  void sortParts(std::span<const double> part_keys, GroupedOrder& order);

  std::vector<Keyed> groups_, members_;
  std::vector<std::uint32_t> parts_, first_of_;  // the order before
};

}  // namespace sightline::layers
