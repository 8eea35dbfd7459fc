#pragma once

// Draws a frame with see-through objects ordered by the distances of their centres, as most programs do.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/render/layer_renderer.h"

namespace sightline::tool {

struct DistanceOrder {
  // Objects that are not blended, by number, then blended objects from the farthest centre to the nearest.
  // Distances are to the centres of the bounding boxes; in an orthographic view they are measured along the
  // view.
  std::vector<ObjectId> order;
  std::size_t first_blended = 0;
};
// Orders objects by distance. scene_from_stored: one per object, or empty.
DistanceOrder orderByDistance(const SceneView& scene, const View& view, std::span<const ObjectId> objects,
                              std::span<const Mat4> scene_from_stored);

// Counts of pairs of blended objects that overlap in some pixel in which no opaque object hides either.
struct DistancePairs {
  std::uint64_t overlapping = 0;
  std::uint64_t wrong = 0;  // pairs of which the one drawn first is in front of the other in some pixel
  // Wrong pairs with the opposite order in another pixel, so that no order of the two is right.
  std::uint64_t without_order = 0;
};
// Counts wrong pairs by drawing each blended object alone, with the renderer's transforms. The nearest
// surfaces of two objects in a pixel are compared; a difference below 1e-5 of the distance is ignored.
DistancePairs countWrongPairs(LayerRenderer& renderer, const View& view, const DistanceOrder& order);

// Draws the picture without the sky: opaque objects with a depth buffer, then blended objects in the given
// order.
void drawByDistance(LayerRenderer& renderer, const View& view, const DistanceOrder& order, LayerImage& image);

}  // namespace sightline::tool
