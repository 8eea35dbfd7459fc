#pragma once

// Minimum occluder sets: the combination table of an occludee, and the search for the cheapest sets that hit
// all slots of the table. Occluders are numbers here, from 0.

#include <cstdint>
#include <span>
#include <vector>

#include "src/base/rows.h"

namespace sightline::comparison {

// Holds, for each pixel of an occludee's image, the occluders in front of it. Pixels with the same occluders
// form one slot.
class CombinationTable {
 public:
  void clear();
  // Adds the occluders of one or several pixels, each named once, in any order. If there are none, nothing
  // hides the occludee.
  void add(std::span<const std::uint32_t> members);
  // Call when all slots are added. Sorts the slots by their number of occluders, then by their members, and
  // drops duplicates. Also drops a slot that contains all members of one of the first 256 that are left:
  // whatever hits the smaller slot hits both.
  void finish();

  std::uint32_t slotCount() const { return static_cast<std::uint32_t>(slots_.size()); }
  // Ascending.
  std::span<const std::uint32_t> slot(std::uint32_t index) const {
    return std::span(members_).subspan(slots_[index].first, slots_[index].count);
  }

 private:
  struct Slot {
    std::uint32_t first = 0, count = 0;  // of members_
    std::uint64_t signature = 0;         // a bit for each member; members may share bits
  };
  std::span<const std::uint32_t> membersOf(const Slot& slot) const {
    return std::span(members_).subspan(slot.first, slot.count);
  }
  bool containsAll(const Slot& slot, const Slot& smaller) const;

  std::vector<Slot> slots_;
  std::vector<std::uint32_t> members_;
};

struct MinimumSet {
  double cost = 0.0;
  std::vector<std::uint32_t> members;  // ascending
};

struct SearchLimits {
  std::uint32_t sets = 4;     // that many of the cheapest are kept
  std::uint32_t steps = 256;  // occluders picked, in all branches together
};

// Searches the minimum sets of one table after the other, and keeps its storage.
class MinimumSetSearch {
 public:
  // Finds sets that have a member in every slot and of which no member can be left out, cheapest first, of
  // equal cost the one that was found first. The cost of a set is the sum of its members' costs. With enough
  // steps these are the cheapest sets there are; with fewer, the cheapest that were found. A table without
  // slots, or with an empty slot, has none. Sets of more than 4096 occluders are not looked for. cost_of: >=
  // 0, by the number of the occluder.
  std::span<const MinimumSet> find(const CombinationTable& table, std::span<const double> cost_of,
                                   const SearchLimits& limits);

 private:
  void prepare(const CombinationTable& table, std::span<const double> cost_of);
  void orderMembers(const CombinationTable& table);
  void extend(std::uint32_t slot);
  bool pick(std::uint32_t member);
  void unpick(std::uint32_t member);
  bool tooExpensive(double cost) const;
  void keep();

  SearchLimits limits_;
  std::uint32_t steps_left_ = 0;

  // Members are numbered anew, by their place in number_of_.
  std::vector<std::uint32_t> number_of_;  // by member, ascending
  std::vector<double> cost_of_;           // by member
  base::Rows<std::uint32_t> members_of_;  // by slot, the most promising first
  base::Rows<std::uint32_t> slots_of_;    // by member, ascending

  // The state of the search.
  std::vector<std::uint32_t> picked_;     // members
  std::vector<std::uint32_t> hits_;       // by slot: how many of its members are picked
  std::vector<std::uint32_t> hitters_;    // by slot: those, combined by exclusive or
  std::vector<std::uint32_t> only_hits_;  // by member: slots in which it alone is picked
  std::vector<std::uint32_t>
      tried_;  // by member: 1 + the slot in which all sets with it were looked at, or 0
  double cost_ = 0.0;

  std::vector<MinimumSet> kept_;  // [0, kept_count_), cheapest first; the others are storage
  std::uint32_t kept_count_ = 0;
};

}  // namespace sightline::comparison
