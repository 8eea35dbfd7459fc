#pragma once

// Finds what is recorded of the claims of a baked file: that objects are hidden from a cell, or from a side
// of its plane.

#include <cstdint>
#include <functional>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "sightline/pvs/format/witness.h"
#include "tools/sightline/cull/hidden_pairs.h"

namespace sightline::tool {

// A place in BoxTree::objects and a witness that hides it.
struct WitnessUse {
  std::uint32_t position = 0, witness = 0;
  friend bool operator==(const WitnessUse&, const WitnessUse&) = default;
  friend auto operator<=>(const WitnessUse&, const WitnessUse&) = default;
};

// Where the witnesses of a claim are: at its cell, at one around it, or at those below it.
enum class WitnessPlace : std::uint8_t { kNone, kHere, kAround, kBelow };

// What was found for one position: uses [first_use, first_use + use_count) of all that were found.
struct FoundWitnesses {
  WitnessPlace place = WitnessPlace::kNone;
  std::uint32_t use_count = 0;
  std::size_t first_use = 0;
};

class WitnessIndex {
 public:
  explicit WitnessIndex(const std::vector<HidingWitness>& witnesses);

  // True if no eye is in the claims' part of a cell, given by its number.
  using IsEmpty = std::function<bool(std::uint64_t)>;

  // Finds for each position, ascending, the witnesses that together show that it is hidden from a part of a
  // cell: one of this cell, or of one around it, or one for each of the eight cells below it, but for those
  // without eyes. Appends them to `uses`, and says in `found`, one for each position, where they are.
  void find(std::uint64_t cell, CellPart part, std::span<const std::uint32_t> positions,
            const IsEmpty& is_empty, std::vector<WitnessUse>& uses, std::vector<FoundWitnesses>& found) const;

 private:
  struct Run {
    std::uint32_t begin = 0, end = 0, witness = 0;
  };
  struct Range {
    std::size_t first = 0, count = 0;
  };
  using Positions = std::vector<std::uint32_t>;

  // Both take the positions that they find from those that are open.
  void findOwn(std::uint64_t cell, CellPart part, Positions& open, std::vector<WitnessUse>& uses) const;
  void findIn(std::uint64_t cell, WitnessPart part, Positions& open, std::vector<WitnessUse>& uses) const;
  // Leaves the positions that some cell below does not hide; uses of such positions may be appended too.
  void findBelow(std::uint64_t cell, CellPart part, Positions& open, const IsEmpty& is_empty,
                 std::vector<WitnessUse>& uses) const;

  std::vector<Run> runs_;                            // of each part of each cell together, by their begin
  std::unordered_map<std::uint64_t, Range> ranges_;  // of runs_, by cell and part
  std::unordered_set<std::uint64_t> has_below_;      // cells around cells that have witnesses
};

}  // namespace sightline::tool
