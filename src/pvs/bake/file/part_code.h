#pragma once

// Baked parts as bytes. Reading is for bytes of any origin.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sightline/pvs/bake/bake.h"
#include "sightline/pvs/format/witness.h"
#include "src/base/byte_stream.h"
#include "src/pvs/bake/cell_tree.h"

namespace sightline::pvs {

inline constexpr std::uint64_t kPartMagic = 0x5452415054484753u;

inline constexpr std::uint64_t kRootPart = 1;  // the id of the part of the octree's root

// The header of a part. After it come blocks of bytes, each with its length before it: the cells, if the part
// has leaves, or what it sees, if it was divided into parts; the witnesses, if they are recorded; and the
// answers, if they are. The cells, what is seen, and the witnesses are packed.
struct PartHead {
  std::uint64_t magic = kPartMagic, plan = 0, id = 0;
  PartSummary summary;
  double search_distance = 0.0;  // for the parts that it was divided into

  bool divided() const { return summary.leaves == 0; }
};
void write(const PartHead& head, base::ByteWriter& bytes);
PartHead readHead(base::ByteReader& bytes);
void addBlock(std::span<const std::byte> block, base::ByteWriter& bytes);

// A part with its blocks as they are in its bytes.
struct PartContent {
  PartHead head;
  std::span<const std::byte> main, witnesses, answers;
};
// Nothing if the bytes are not made up of a head and these blocks.
std::optional<PartContent> contentOf(const BakeSettings& settings, std::span<const std::byte> part);

// The cell of a part that was not divided, with all below it. Nothing if the bytes are no such cell.
std::optional<BakedCell> cellOf(const BakeScene& scene, const PartContent& content);
// True if the bytes of a part that was divided say what it sees.
bool soundlyDivided(const BakeScene& scene, const PartContent& content);
// The witnesses of a part; none if they are not recorded. Nothing if the part's bytes are not witnesses.
std::optional<std::vector<HidingWitness>> witnessesOf(const BakeSettings& settings,
                                                      const PartContent& content);

}  // namespace sightline::pvs
