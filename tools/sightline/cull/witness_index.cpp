#include "tools/sightline/cull/witness_index.h"

#include <algorithm>
#include <iterator>

namespace sightline::tool {
namespace {

// A cell's number has 61 bits at most.
std::uint64_t keyOf(std::uint64_t cell, WitnessPart part) {
  return cell * 4 + static_cast<std::uint64_t>(part);
}

}  // namespace

WitnessIndex::WitnessIndex(const std::vector<HidingWitness>& witnesses) {
  std::vector<std::uint32_t> order(witnesses.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    order[i] = i;
  }
  const auto key = [&](std::uint32_t i) { return keyOf(witnesses[i].cell, witnesses[i].part); };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  for (std::size_t i = 0; i < order.size();) {
    const std::uint64_t here = key(order[i]);
    const std::size_t first = runs_.size();
    for (; i < order.size() && key(order[i]) == here; ++i) {
      for (const HidingWitness::Run& run : witnesses[order[i]].hidden) {
        runs_.push_back({run.begin, run.end, order[i]});
      }
    }
    std::stable_sort(runs_.begin() + static_cast<std::ptrdiff_t>(first), runs_.end(),
                     [](const Run& a, const Run& b) { return a.begin < b.begin; });
    ranges_[here] = {first, runs_.size() - first};
    for (std::uint64_t cell = here / 4 / 8; cell > 0 && has_below_.insert(cell).second;) {
      cell /= 8;
    }
  }
}

// If any of the runs that have begun holds a position, the one with the farthest end does.
void WitnessIndex::findIn(std::uint64_t cell, WitnessPart part, Positions& open,
                          std::vector<WitnessUse>& uses) const {
  const auto range = ranges_.find(keyOf(cell, part));
  if (open.empty() || range == ranges_.end()) {
    return;
  }
  const Run* next = runs_.data() + range->second.first;
  const Run* const end = next + range->second.count;
  Run farthest;
  std::erase_if(open, [&](std::uint32_t position) {
    for (; next != end && next->begin <= position; ++next) {
      if (next->end > farthest.end) {
        farthest = *next;
      }
    }
    if (position >= farthest.end) {
      return false;
    }
    uses.push_back({position, farthest.witness});
    return true;
  });
}

// What is hidden from the whole cell is hidden from each part of it.
void WitnessIndex::findOwn(std::uint64_t cell, CellPart part, Positions& open,
                           std::vector<WitnessUse>& uses) const {
  findIn(cell, WitnessPart::kWhole, open, uses);
  if (part == CellPart::kFront || part == CellPart::kBack) {
    findIn(cell, part == CellPart::kFront ? WitnessPart::kFront : WitnessPart::kBack, open, uses);
  }
}

void WitnessIndex::findBelow(std::uint64_t cell, CellPart part, Positions& open, const IsEmpty& is_empty,
                             std::vector<WitnessUse>& uses) const {
  if (open.empty() || !has_below_.contains(cell)) {
    return;
  }
  Positions failed, held = open;
  for (std::uint64_t i = 0; i < 8; ++i) {
    const std::uint64_t child = 8 * cell + i;
    if (is_empty(child)) {
      continue;
    }
    Positions rest = held;
    findOwn(child, part, rest, uses);
    findBelow(child, part, rest, is_empty, uses);
    Positions still;
    std::set_difference(held.begin(), held.end(), rest.begin(), rest.end(), std::back_inserter(still));
    held.swap(still);
    failed.insert(failed.end(), rest.begin(), rest.end());
  }
  std::sort(failed.begin(), failed.end());
  open.swap(failed);
}

void WitnessIndex::find(std::uint64_t cell, CellPart part, std::span<const std::uint32_t> positions,
                        const IsEmpty& is_empty, std::vector<WitnessUse>& uses,
                        std::vector<FoundWitnesses>& found) const {
  found.assign(positions.size(), {});
  Positions open(positions.begin(), positions.end());
  std::vector<WitnessUse> here;
  const auto place = [&](WitnessPlace where) {
    std::sort(here.begin(), here.end());
    auto position = positions.begin();
    for (const WitnessUse& use : here) {
      position = std::lower_bound(position, positions.end(), use.position);
      FoundWitnesses& one = found[static_cast<std::size_t>(position - positions.begin())];
      if (one.use_count == 0) {
        one = {where, 0, uses.size()};
      }
      one.use_count += 1;
      uses.push_back(use);
    }
    here.clear();
  };
  findOwn(cell, part, open, here);
  place(WitnessPlace::kHere);
  for (std::uint64_t around = cell / 8; around > 0; around /= 8) {
    findOwn(around, CellPart::kWhole, open, here);
  }
  place(WitnessPlace::kAround);
  findBelow(cell, part, open, is_empty, here);
  // What stayed open is hidden from some of the cells below only.
  std::erase_if(here, [&](const WitnessUse& use) {
    return std::binary_search(open.begin(), open.end(), use.position);
  });
  place(WitnessPlace::kBelow);
}

}  // namespace sightline::tool
