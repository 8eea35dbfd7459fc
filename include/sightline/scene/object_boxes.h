#pragma once

// Several boxes an object. One box around an L-shaped house, a diagonal beam or a row of lamps is mostly
// empty, and the object is kept wherever one corner of that box shows.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sightline/base/ids.h"
#include "sightline/base/large_vector.h"
#include "sightline/base/parallel_for.h"
#include "sightline/base/result.h"
#include "sightline/math/box.h"
#include "sightline/scene/scene.h"

namespace sightline {

inline constexpr std::uint32_t kMaxObjectBoxes = 8;

// Made by findObjectBoxes(). Scene space.
struct ObjectBoxes {
  std::vector<std::uint32_t> first{};  // by ObjectId: its first box; and one more entry, the number of boxes
  std::vector<Box> boxes{};

  // Two to kMaxObjectBoxes boxes that together hold all of the object's triangles, each within
  // Object::bounds. Empty if one box, Object::bounds, serves as well. object: of the scene.
  std::span<const Box> of(ObjectId object) const {
    return std::span(boxes).subspan(first[object.value], first[object.value + 1] - first[object.value]);
  }
};

struct ObjectBoxesSettings {
  std::uint32_t max_boxes = kMaxObjectBoxes;  // for one object; more than kMaxObjectBoxes counts as that many
  // What one more box has to save: a share of the object's own box, by volume. For flat and thin objects each
  // box counts as if it were a 16th of the object's length thicker, along all axes.
  double min_saving = 0.005;
  // Metres by which all boxes are wider than what they hold, as Object::bounds then has to be as well: see
  // ClosedScene::margin().
  double margin = 0.0;
};

// Whether the boxes may be those of an object with these bounds: they are well formed and together reach
// exactly as far. Others, of an object that has changed or whose bounds are wider than its triangles, must
// not be tested in place of the bounds.
bool areBoxesOf(std::span<const Box> boxes, const Box& bounds);

// Finds the boxes of all objects, in time linear in the number of triangles. Objects with coordinates that
// are not finite have one box. Copies of an object at other places are divided where it is, which takes less
// time. The result does not depend on parallel_for.
ObjectBoxes findObjectBoxes(const SceneView& scene, const ObjectBoxesSettings& settings = {},
                            const ParallelFor& parallel_for = serialFor);

// The boxes as bytes, to be read again instead of found: on a machine of the same kind, by a program of the
// same version. They say neither of which scene nor with which settings they were found.
LargeVector<std::byte> objectBoxesBytes(const ObjectBoxes& boxes);
// Error if they are cut off, of another version or another number of objects, or some are not well formed.
// Whether they are those that were written, of this scene, is for the caller to check, by a checksum.
Result<ObjectBoxes> objectBoxesFrom(std::span<const std::byte> bytes, std::uint32_t object_count);

}  // namespace sightline
