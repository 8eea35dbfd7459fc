#pragma once

// Potentially visible sets as culling asks for them: what may be seen from the cell that the eye is in,
// whatever the direction. Implemented by sightline::pvs over a baked file.

#include <cstdint>
#include <span>

#include "sightline/hierarchy/box_tree.h"
#include "sightline/math/vec3.h"

namespace sightline {

struct VisibleSet {
  static constexpr std::uint32_t kEverything = 0xffffffffu;

  std::uint32_t id = kEverything;  // equal ids of one VisibleSets are equal sets
  // Of VisibleSets::boxes(), ascending, none below another: all objects below them, and no other ones, may be
  // seen. The root alone: everything.
  std::span<const std::uint32_t> nodes{};
};

// Used by one thread at a time.
class VisibleSets {
 public:
  virtual ~VisibleSets() = default;

  // Each leaf is one object with its box, as the sets were made for it. A Culler compares them with its own
  // boxes, and uses no sets of other ones. They stay where they are as long as the sets are in use.
  virtual BoxTreeView boxes() const = 0;

  // For a perspective view from `eye` (scene space) in any direction. near_distance: how far from the eye the
  // farthest point lies that the near plane clips away (nearDistance), metres. Everything where nothing is
  // known: outside the cells, for what is not finite, and for a near_distance beyond that of the bake.
  // Valid until the next call. Does not allocate after warm-up.
  virtual VisibleSet find(const Vec3d& eye, double near_distance) = 0;
};

}  // namespace sightline
