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

  std::uint32_t id = kEverything;  // sets of one VisibleSets with equal ids are equal
  // Nodes of VisibleSets::boxes(), ascending, none below another. All objects below them, and no others, may
  // be seen. The root alone stands for everything.
  std::span<const std::uint32_t> nodes{};
};

// Used by one thread at a time.
class VisibleSets {
 public:
  virtual ~VisibleSets() = default;

  // The boxes that the sets were made for; each leaf is one object with its box. A Culler compares them with
  // its own boxes and does not use sets of other boxes. The view must stay valid as long as the sets are in
  // use.
  virtual BoxTreeView boxes() const = 0;

  // Returns the set for a perspective view from `eye` (scene space) in any direction, valid until the next
  // call. near_distance: distance from the eye of the farthest point that the near plane clips away
  // (nearDistance), metres. The set is everything outside the cells, for values that are not finite, and for
  // a near_distance beyond that of the bake. Does not allocate after warm-up.
  virtual VisibleSet find(const Vec3d& eye, double near_distance) = 0;
};

}  // namespace sightline
