#pragma once

// Convex bodies as polygons of a depth buffer: the outline of all faces that are seen, with the depths of
// their planes.

#include <cstdint>

#include "src/occlusion/eye_occluder.h"
#include "src/occlusion/polygons/polygon_projection.h"

namespace sightline::occlusion {

// Appends the polygon of a body as the occluder `id`, unless the body lies off the buffer. False: its faces
// are to be drawn one by one, because it reaches the near plane, a face is seen at a grazing angle, or more
// than BufferPolygon::kMaxPlanes faces are seen. outline: scratch.
bool appendBody(const PolygonProjection& projection, const Eye& eye, const OccluderSet& set, OccluderId id,
                const OccluderBody& body, CameraOutline& outline, BufferPolygons& polygons);

}  // namespace sightline::occlusion
