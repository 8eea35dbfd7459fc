#include "tools/sightline/cull/check_claims.h"

#include <algorithm>

namespace sightline::tool {
namespace {

bool holds(const HidingWitness& witness, std::uint32_t position) {
  const auto after =
      std::upper_bound(witness.hidden.begin(), witness.hidden.end(), position,
                       [](std::uint32_t p, const HidingWitness::Run& run) { return p < run.begin; });
  return after != witness.hidden.begin() && position < std::prev(after)->end;
}

// What is hidden from the whole cell is hidden from each part of it.
bool covers(WitnessPart witness, CellPart part) {
  return witness == WitnessPart::kWhole || (witness == WitnessPart::kFront && part == CellPart::kFront) ||
         (witness == WitnessPart::kBack && part == CellPart::kBack);
}

}  // namespace

WitnessIndex::WitnessIndex(const std::vector<HidingWitness>& witnesses) : witnesses_(witnesses) {
  for (std::uint32_t i = 0; i < witnesses.size(); ++i) {
    by_cell_[witnesses[i].cell].push_back(i);
    for (std::uint64_t cell = witnesses[i].cell; cell > 1;) {
      cell /= 8;
      has_below_.insert(cell);
    }
  }
}

bool WitnessIndex::findOwn(std::uint64_t cell, CellPart part, std::uint32_t position,
                           std::vector<WitnessUse>& uses) const {
  const auto here = by_cell_.find(cell);
  if (here == by_cell_.end()) {
    return false;
  }
  const auto found = std::find_if(here->second.begin(), here->second.end(), [&](std::uint32_t i) {
    return covers(witnesses_[i].part, part) && holds(witnesses_[i], position);
  });
  if (found == here->second.end()) {
    return false;
  }
  uses.push_back({*found, position});
  return true;
}

bool WitnessIndex::findBelow(std::uint64_t cell, CellPart part, std::uint32_t position,
                             const IsEmpty& is_empty, std::vector<WitnessUse>& uses) const {
  if (!has_below_.contains(cell)) {
    return false;
  }
  const std::size_t before = uses.size();
  for (std::uint64_t i = 0; i < 8; ++i) {
    const std::uint64_t child = 8 * cell + i;
    if (!findOwn(child, part, position, uses) && !findBelow(child, part, position, is_empty, uses) &&
        !is_empty(child)) {
      uses.resize(before);
      return false;
    }
  }
  return true;
}

bool WitnessIndex::find(std::uint64_t cell, CellPart part, std::uint32_t position, const IsEmpty& is_empty,
                        std::vector<WitnessUse>& uses) const {
  if (findOwn(cell, part, position, uses)) {
    return true;
  }
  for (std::uint64_t around = cell / 8; around > 0; around /= 8) {
    if (findOwn(around, CellPart::kWhole, position, uses)) {
      return true;
    }
  }
  return findBelow(cell, part, position, is_empty, uses);
}

}  // namespace sightline::tool
