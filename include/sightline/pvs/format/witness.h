#pragma once

// Witnesses: what a bake found that hides objects from a cell, as plain data beside the baked file, so that
// others can check its claims.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sightline/base/ids.h"
#include "sightline/base/result.h"
#include "sightline/pvs/format/scene_id.h"
#include "sightline/pvs/format/visibility_octree.h"

namespace sightline {

// What hides the objects.
enum class WitnessKind : std::uint8_t {
  kConvex,    // one convex occluder
  kSurfaces,  // the surface that a line of sight crosses
  kBoxes,     // surfaces hide each of several boxes around the object's triangles
  kNarrowed,  // the same of what narrowing leaves of the cell and the object
  kDivided,   // the same of each half of the cell or of the object's box
};
inline constexpr std::uint32_t kWitnessKinds = 5;

// The region from which they are hidden: a cell, or the side of its plane.
enum class WitnessPart : std::uint8_t { kWhole, kFront, kBack };
inline constexpr std::uint32_t kWitnessParts = 3;

struct HidingWitness {
  static constexpr std::uint32_t kNoOccluder = 0xffffffffu;

  // Places in BoxTree::objects, [begin, end).
  struct Run {
    std::uint32_t begin = 0, end = 0;
    friend bool operator==(const Run&, const Run&) = default;
  };

  std::uint64_t cell = 1;  // see cellNumber; it may be an ancestor of a leaf, or below one that was merged
  WitnessPart part = WitnessPart::kWhole;
  WitnessKind kind = WitnessKind::kConvex;
  std::uint32_t occluder = kNoOccluder;  // kConvex: its number, or that of the body's first face
  ObjectId object{};                     // kConvex, kSurfaces: whose triangles hide
  Vec3d from{}, to{};                    // kSurfaces: the line of sight, scene space; finite
  std::vector<Run> hidden{};             // ascending, not empty

  friend bool operator==(const HidingWitness&, const HidingWitness&) = default;
};

// The number of a cell: 1 for the root, 8 * n + i for child i of cell n.
std::uint64_t cellNumber(const OctreeCell& cell);
// The cell of a number, which must not be 0.
OctreeCell cellOfNumber(std::uint64_t number);

// All that a bake recorded.
struct Witnesses {
  SceneId scene{};
  Vec3d root_min{}, root_max{};  // of the octree, scene space
  std::vector<HidingWitness> all{};
};

// Writes and reads the bytes of a file. Reading is for bytes of any origin: an error tells what is wrong with
// them, and what is read has kinds, parts, cells and runs in range; whose objects there are it cannot know.
std::vector<std::byte> witnessBytes(const Witnesses& witnesses);
Result<Witnesses> readWitnesses(std::span<const std::byte> bytes, const std::string& name);

}  // namespace sightline
