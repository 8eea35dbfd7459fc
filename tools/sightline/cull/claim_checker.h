#pragma once

// Decides every claim of a baked file: that an object is hidden from a cell, or from a side of its plane.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/pvs/format/witness.h"
#include "sightline/pvs/query/sight_file.h"
#include "sightline/scene/scene.h"

namespace sightline::tool {

// One row for each kind of witness, then claims that rest on witnesses of cells below, those about parts of
// cells that hold no eye, and those without.
inline constexpr std::size_t kOfCellsBelow = kWitnessKinds, kNoEyes = kWitnessKinds + 1,
                             kWithout = kWitnessKinds + 2, kCheckRows = kWitnessKinds + 3;

struct CheckRow {
  std::uint64_t claims = 0, proved = 0, survived = 0, contradicted = 0;
};

struct ContradictedClaim {
  std::uint32_t leaf = 0;
  ObjectId object;
  Vec3d eye{}, point{};  // scene space: an eye in the cell, and what it sees of the object
};

struct CheckReport {
  std::array<CheckRow, kCheckRows> rows{};
  std::uint64_t inherited = 0;  // claims whose witness is of a cell around theirs
  std::vector<ContradictedClaim> contradicted{};

  CheckRow sum() const;
};

struct ClaimCheckSettings {
  std::uint32_t divisions = 2;  // see RegionProof::provesInParts
  std::uint32_t rays = 16;      // for each claim that is not proved, at most
  std::uint32_t seed = 1;       // of the rays
  std::uint32_t threads = 1;
  // Doors of the file that are closed, ascending; the scene's other doors are marked as never occluders.
  std::vector<ObjectId> closed{};
};

// Goes through the file leaf by leaf, so that memory does not grow with the number of claims. The rays of a
// claim depend on the seed, its cell and its object only. Error if a set is corrupt, or a witness is false or
// names what is not there; it begins with `witness_file`.
Result<CheckReport> checkClaims(const SightFile& baked, const Scene& scene,
                                const std::vector<HidingWitness>& witnesses, const std::string& witness_file,
                                const ClaimCheckSettings& settings);

}  // namespace sightline::tool
