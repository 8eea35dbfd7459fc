#pragma once

// What an order of see-through things by the distances of their centres, as most programs draw them, makes of
// a frame.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/render/layer_renderer.h"

namespace sightline::tool {

struct DistanceOrder {
  // Objects by number: those that are not blended, then the blended ones from the farthest centre to the
  // nearest. Distances are to the middles of the boxes; along the view where it is orthographic.
  std::vector<ObjectId> order;
  std::size_t first_blended = 0;
};
// scene_from_stored: one an object, or none.
DistanceOrder orderByDistance(const SceneView& scene, const View& view, std::span<const ObjectId> objects,
                              std::span<const Mat4> scene_from_stored);

// Pairs of blended objects that share pixels of the picture in which opaque ones hide neither.
struct DistancePairs {
  std::uint64_t overlapping = 0;
  std::uint64_t wrong = 0;  // in some pixel the one that is drawn first lies before the other
  // Of the wrong ones: in some other pixel it is the other way round. No order of the two is right.
  std::uint64_t without_order = 0;
};
// By drawing each blended object alone, with the transforms that the renderer has. What counts is the nearest
// surface of each in a pixel; nearer to each other than a hundred-thousandth of the distance: nothing.
DistancePairs countWrongPairs(LayerRenderer& renderer, const View& view, const DistanceOrder& order);

// The picture without the sky: opaque objects by a depth buffer, blended ones over them in the order.
void drawByDistance(LayerRenderer& renderer, const View& view, const DistanceOrder& order, LayerImage& image);

}  // namespace sightline::tool
