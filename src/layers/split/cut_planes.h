#pragma once

// The planes by which a part in a cycle is tried to be divided.

#include <span>
#include <vector>

#include "sightline/math/plane.h"
#include "src/layers/pairs/convex_pair.h"
#include "src/layers/split/part_shape.h"

namespace sightline::layers {

// Returns planes in the part's space with normals of unit length: across the axes of the part's own box, and
// through the middle and along both flat sides of each neighbour, by which the part's near and far sides come
// apart. Parts of very many triangles get only the first kind, in the middle.
// neighbours: placed hulls of parts that occlude the part or that it occludes. placement: of the part.
std::vector<Plane> cutPlanes(const PartShape& shape, const Placement& placement,
                             std::span<const ConvexSet> neighbours);

}  // namespace sightline::layers
