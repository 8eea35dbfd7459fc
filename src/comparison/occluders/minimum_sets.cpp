// Based on: Poon, Wang. Occlusion Culling Using Minimum Occluder Set and Opacity Map. IV 1999, section 4.2.
// Redundancy by counting the slots that a member alone hits: Murakami, Uno. Efficient Algorithms for
// Dualizing Large-Scale Hypergraphs. Discrete Applied Mathematics 170, 2014.
// Differs from the paper in: a branch ends as soon as a picked occluder has become redundant, since adding
// others never makes it needed again; an occluder that was tried in a slot is not picked further down in the
// branches of its neighbours in that slot, so that no set is found twice; slots are tried best occluder
// first; the number of picks is limited.

#include "src/comparison/occluders/minimum_sets.h"

#include <algorithm>
#include <utility>

namespace sightline::comparison {
namespace {

// Both bound the time and the stack that hostile tables take; tables of real scenes are far smaller.
constexpr std::size_t kComparedSlots = 256;
constexpr std::size_t kMaxMembers = 4096;

}  // namespace

void CombinationTable::clear() {
  slots_.clear();
  members_.clear();
}

void CombinationTable::add(std::span<const std::uint32_t> members) {
  Slot slot;
  slot.first = static_cast<std::uint32_t>(members_.size());
  slot.count = static_cast<std::uint32_t>(members.size());
  members_.insert(members_.end(), members.begin(), members.end());
  std::sort(members_.begin() + slot.first, members_.end());
  for (const std::uint32_t member : members) {
    slot.signature |= std::uint64_t{1} << (member % 64u);
  }
  slots_.push_back(slot);
}

bool CombinationTable::containsAll(const Slot& slot, const Slot& smaller) const {
  if ((smaller.signature & ~slot.signature) != 0) {
    return false;
  }
  const auto large = membersOf(slot), small = membersOf(smaller);
  return std::includes(large.begin(), large.end(), small.begin(), small.end());
}

void CombinationTable::finish() {
  std::sort(slots_.begin(), slots_.end(), [this](const Slot& a, const Slot& b) {
    if (a.count != b.count) {
      return a.count < b.count;
    }
    const auto in_a = membersOf(a), in_b = membersOf(b);
    return std::lexicographical_compare(in_a.begin(), in_a.end(), in_b.begin(), in_b.end());
  });
  std::size_t kept = 0;
  for (const Slot& slot : slots_) {
    const auto compared = slots_.begin() + static_cast<std::ptrdiff_t>(std::min(kept, kComparedSlots));
    const bool is_twice = kept > 0 && std::ranges::equal(membersOf(slot), membersOf(slots_[kept - 1]));
    if (!is_twice && std::none_of(slots_.begin(), compared,
                                  [&](const Slot& smaller) { return containsAll(slot, smaller); })) {
      slots_[kept++] = slot;
    }
  }
  slots_.resize(kept);
}

std::span<const MinimumSet> MinimumSetSearch::find(const CombinationTable& table,
                                                   std::span<const double> cost_of,
                                                   const SearchLimits& limits) {
  limits_ = limits;
  steps_left_ = limits.steps;
  kept_count_ = 0;
  // An empty slot is the first one: they are sorted.
  if (table.slotCount() > 0 && !table.slot(0).empty() && limits.sets > 0 && limits.steps > 0) {
    prepare(table, cost_of);
    extend(0);
  }
  return std::span<const MinimumSet>(kept_).first(kept_count_);
}

void MinimumSetSearch::prepare(const CombinationTable& table, std::span<const double> cost_of) {
  const std::uint32_t slots = table.slotCount();
  number_of_.clear();
  for (std::uint32_t s = 0; s < slots; ++s) {
    const auto members = table.slot(s);
    number_of_.insert(number_of_.end(), members.begin(), members.end());
  }
  std::sort(number_of_.begin(), number_of_.end());
  number_of_.erase(std::unique(number_of_.begin(), number_of_.end()), number_of_.end());
  cost_of_.clear();
  for (const std::uint32_t number : number_of_) {
    cost_of_.push_back(cost_of[number]);
  }
  orderMembers(table);
  picked_.clear();
  hits_.assign(slots, 0);
  hitters_.assign(slots, 0);
  only_hits_.assign(number_of_.size(), 0);
  tried_.assign(number_of_.size(), 0);
  cost_ = 0.0;
}

// Fills the lists of members by slot and of slots by member. An occluder is promising when it hits many slots
// for its cost; ties by number.
void MinimumSetSearch::orderMembers(const CombinationTable& table) {
  members_of_.clear();
  for (std::uint32_t s = 0; s < table.slotCount(); ++s) {
    for (const std::uint32_t number : table.slot(s)) {
      const auto at = std::lower_bound(number_of_.begin(), number_of_.end(), number);
      members_of_.add(static_cast<std::uint32_t>(at - number_of_.begin()));
    }
    members_of_.endRow();
  }
  slots_of_.group(number_of_.size(), [&](auto&& body) {
    for (std::uint32_t s = 0; s < table.slotCount(); ++s) {
      for (const std::uint32_t member : std::as_const(members_of_)[s]) {
        body(member, s);
      }
    }
  });
  const auto slotsFor = [this](std::uint32_t m) {
    return static_cast<double>(slots_of_[m].size()) / cost_of_[m];
  };
  for (std::uint32_t s = 0; s < table.slotCount(); ++s) {
    const std::span<std::uint32_t> members = members_of_[s];
    std::sort(members.begin(), members.end(), [&](std::uint32_t a, std::uint32_t b) {
      const double for_a = slotsFor(a), for_b = slotsFor(b);
      return for_a > for_b || (for_a == for_b && a < b);
    });
  }
}

// Tries the members of the first slot, from this one on, that has none yet.
void MinimumSetSearch::extend(std::uint32_t slot) {
  const auto slots = static_cast<std::uint32_t>(hits_.size());
  while (slot < slots && hits_[slot] > 0) {
    ++slot;
  }
  if (slot == slots) {
    keep();
    return;
  }
  if (picked_.size() == kMaxMembers) {
    return;
  }
  const std::span<const std::uint32_t> members = std::as_const(members_of_)[slot];
  for (const std::uint32_t member : members) {
    if (tried_[member] != 0) {
      continue;
    }
    if (!tooExpensive(cost_ + cost_of_[member])) {
      if (steps_left_ == 0) {
        break;
      }
      --steps_left_;
      const double cost_before = cost_;
      if (pick(member)) {
        extend(slot + 1);
      }
      unpick(member);
      cost_ = cost_before;
    }
    tried_[member] = slot + 1;
  }
  for (const std::uint32_t member : members) {
    if (tried_[member] == slot + 1) {
      tried_[member] = 0;
    }
  }
}

// False: some member, maybe another one, is redundant now.
bool MinimumSetSearch::pick(std::uint32_t member) {
  bool all_needed = true;
  for (const std::uint32_t slot : slots_of_[member]) {
    if (hits_[slot] == 0) {
      ++only_hits_[member];
    } else if (hits_[slot] == 1) {
      all_needed = --only_hits_[hitters_[slot]] > 0 && all_needed;
    }
    ++hits_[slot];
    hitters_[slot] ^= member;
  }
  picked_.push_back(member);
  cost_ += cost_of_[member];
  return all_needed && only_hits_[member] > 0;
}

void MinimumSetSearch::unpick(std::uint32_t member) {
  picked_.pop_back();
  for (const std::uint32_t slot : slots_of_[member]) {
    --hits_[slot];
    hitters_[slot] ^= member;
    if (hits_[slot] == 0) {
      --only_hits_[member];
    } else if (hits_[slot] == 1) {
      ++only_hits_[hitters_[slot]];
    }
  }
}

// A set that costs so much would not be kept.
bool MinimumSetSearch::tooExpensive(double cost) const {
  return kept_count_ == limits_.sets && cost >= kept_[kept_count_ - 1].cost;
}

void MinimumSetSearch::keep() {
  if (kept_count_ < limits_.sets) {
    if (kept_.size() == kept_count_) {
      kept_.emplace_back();
    }
    ++kept_count_;
  }
  MinimumSet& place = kept_[kept_count_ - 1];  // free, or the worst
  place.cost = cost_;
  place.members.clear();
  for (const std::uint32_t member : picked_) {
    place.members.push_back(number_of_[member]);
  }
  std::sort(place.members.begin(), place.members.end());
  for (std::uint32_t i = kept_count_ - 1; i > 0 && kept_[i].cost < kept_[i - 1].cost; --i) {
    std::swap(kept_[i], kept_[i - 1]);
  }
}

}  // namespace sightline::comparison
