#pragma once

// What doors hide, as plain data beside the sets of a baked file. A door is an object that hides what is
// behind it only while it is closed.
//
// The sets of cells hold while all doors are open. For each set and each group of doors there may be a
// second one: what is hidden as well while all doors of the group are closed, whatever the others do, for
// what is closed besides can only hide more. Each door is a group by itself.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/base/ids.h"

namespace sightline {

// What the doors of a group hide of a set of objects.
struct DoorSet {
  std::uint32_t group = 0;
  std::uint32_t hidden = 0;  // the set that they hide

  friend bool operator==(const DoorSet&, const DoorSet&) = default;
};

// All spans are empty in a file without doors.
struct DoorsView {
  std::span<const ObjectId> doors{};             // of each group, ascending; one group after the other
  std::span<const std::uint32_t> group_ends{};   // by group: where its doors end
  std::span<const DoorSet> hidden{};             // of each set, by ascending group; one set after the other
  std::span<const std::uint32_t> hidden_ends{};  // by set: where what doors hide of it ends

  std::uint32_t groupCount() const { return static_cast<std::uint32_t>(group_ends.size()); }
  std::span<const ObjectId> doorsOf(std::uint32_t group) const { return rowOf(doors, group_ends, group); }
  // Empty if no door hides anything of the set.
  std::span<const DoorSet> hiddenOf(std::uint32_t set) const {
    return hidden_ends.empty() ? std::span<const DoorSet>() : rowOf(hidden, hidden_ends, set);
  }

 private:
  template <typename Item>
  static std::span<const Item> rowOf(std::span<const Item> items, std::span<const std::uint32_t> ends,
                                     std::uint32_t row) {
    const std::uint32_t begin = row == 0 ? 0 : ends[row - 1];
    return items.subspan(begin, ends[row] - begin);
  }
};

struct BakedDoors {
  std::vector<ObjectId> doors{};
  std::vector<std::uint32_t> group_ends{};
  std::vector<DoorSet> hidden{};
  std::vector<std::uint32_t> hidden_ends{};

  DoorsView view() const { return {doors, group_ends, hidden, hidden_ends}; }
};

// The doors of all groups, ascending, each once.
std::vector<ObjectId> allDoors(const DoorsView& doors);
// Whether all doors of the group are among these, which are ascending.
bool isClosed(const DoorsView& doors, std::uint32_t group, std::span<const ObjectId> closed);

}  // namespace sightline
