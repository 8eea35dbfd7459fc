#pragma once

// What a baked file claims: that an object is hidden from everywhere in a cell. And a sample of it.

#include <cstdint>
#include <span>
#include <vector>

#include "oracle/eye_region.h"
#include "sightline/base/result.h"
#include "sightline/pvs/query/sight_file.h"
#include "sightline/scene/scene.h"

namespace sightline::tool {

// A part of a cell that has a set of its own.
enum class CellPart : std::uint8_t { kWhole, kFront, kBetween, kBack };

struct HiddenPair {
  std::uint32_t leaf = 0;  // index into OctreeView::leaves
  CellPart part = CellPart::kWhole;
  ObjectId object;
};

// The eyes for which the look-up returns the part's set: where viewers are expected in the leaf's cell,
// borders included, on one side of its plane. cell: the leaf's, or one below it, for the eyes that are in it
// as well.
EyeRegion regionOf(const OctreeView& octree, const OctreeCell& cell, std::uint32_t leaf, CellPart part);

// Leaves of the region the eyes on the part's side of the leaf's plane.
void addSide(const OctreeView& octree, std::uint32_t leaf, CellPart part, EyeRegion& region);

// Says for each place in BoxTree::objects, with 1, that its object is in the part's set; the others are
// claimed to be hidden while these doors are closed, ascending. Error if a set is corrupt.
Status readVisible(const SightFile& baked, std::uint32_t leaf, CellPart part,
                   std::span<const ObjectId> closed, std::vector<std::uint8_t>& is_visible);

struct HiddenPairs {
  std::vector<OctreeCell> cells;  // of all leaves
  std::vector<HiddenPair> pairs;
};

// Draws at most `count` pairs, each once. Parts of cells are drawn at random. Of each, four hidden objects
// are drawn: any, one that looks large from the cell, one that is close to it, and one that is close to a
// visible object. There are fewer pairs if the file hides less. The same seed gives the same pairs. closed:
// see readVisible. Error if a set is corrupt.
Result<HiddenPairs> sampleHiddenPairs(const SightFile& baked, std::span<const ObjectId> closed,
                                      const Scene& scene, std::uint32_t count, std::uint64_t seed);

}  // namespace sightline::tool
