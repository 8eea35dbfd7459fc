#include "tools/sightline/layers/layer_by_distance.h"

#include <algorithm>
#include <utility>

namespace sightline::tool {
namespace {

constexpr float kTie = 1e-5f;  // differences up to this share of the distance are ignored

// The depths of an object in the pixels in which it is visible, in their smallest rectangle.
struct SeenDepths {
  std::uint32_t left = 0, top = 0, right = 0, bottom = 0;  // right and bottom are exclusive
  std::vector<float> depths;                               // row by row; kNoDepth: not visible

  float at(std::uint32_t x, std::uint32_t y) const {
    return depths[std::size_t{y - top} * (right - left) + (x - left)];
  }
};

// Finds the pixels in which the object is nearer than `hidden_from`, which holds one depth per pixel.
SeenDepths seenDepths(const LayerImage& alone, const std::vector<float>& hidden_from) {
  SeenDepths seen{.left = alone.width, .top = alone.height, .right = 0, .bottom = 0, .depths = {}};
  const auto is_seen = [&](std::size_t pixel) { return alone.depths[pixel] < hidden_from[pixel]; };
  for (std::uint32_t y = 0; y < alone.height; ++y) {
    for (std::uint32_t x = 0; x < alone.width; ++x) {
      if (is_seen(std::size_t{y} * alone.width + x)) {
        seen.left = std::min(seen.left, x);
        seen.right = std::max(seen.right, x + 1);
        seen.top = std::min(seen.top, y);
        seen.bottom = y + 1;
      }
    }
  }
  for (std::uint32_t y = seen.top; y < seen.bottom; ++y) {
    for (std::uint32_t x = seen.left; x < seen.right; ++x) {
      const std::size_t pixel = std::size_t{y} * alone.width + x;
      seen.depths.push_back(is_seen(pixel) ? alone.depths[pixel] : LayerImage::kNoDepth);
    }
  }
  return seen;
}

struct PairLook {
  bool overlap = false;
  bool first_before = false, second_before = false;  // whether one is in front of the other in some pixel
};

PairLook look(const SeenDepths& first, const SeenDepths& second) {
  PairLook found;
  const std::uint32_t left = std::max(first.left, second.left), right = std::min(first.right, second.right);
  const std::uint32_t top = std::max(first.top, second.top), bottom = std::min(first.bottom, second.bottom);
  for (std::uint32_t y = top; y < bottom; ++y) {
    for (std::uint32_t x = left; x < right; ++x) {
      const float a = first.at(x, y), b = second.at(x, y);
      if (a == LayerImage::kNoDepth || b == LayerImage::kNoDepth) {
        continue;
      }
      found.overlap = true;
      found.first_before = found.first_before || a < b * (1.0f - kTie);
      found.second_before = found.second_before || b < a * (1.0f - kTie);
    }
  }
  return found;
}

}  // namespace

DistanceOrder orderByDistance(const SceneView& scene, const View& view, std::span<const ObjectId> objects,
                              std::span<const Mat4> scene_from_stored) {
  DistanceOrder order;
  std::vector<std::pair<double, ObjectId>> blended;  // negated distance and object
  for (const ObjectId id : objects) {
    const Object& object = scene.objects[id.value];
    if (scene.materialOf(object).opacity != Opacity::kBlended) {
      order.order.push_back(id);
      continue;
    }
    Vec3d centre = center(object.bounds);
    if (!scene_from_stored.empty()) {
      centre = transformPoint(scene_from_stored[id.value], centre);
    }
    const Vec3d from_eye = centre - view.eye;
    blended.emplace_back(view.orthographic ? -dot(from_eye, view.forward) : -length(from_eye), id);
  }
  std::sort(blended.begin(), blended.end());
  order.first_blended = order.order.size();
  for (const auto& [negated_distance, id] : blended) {
    order.order.push_back(id);
  }
  return order;
}

DistancePairs countWrongPairs(LayerRenderer& renderer, const View& view, const DistanceOrder& order) {
  const std::span<const ObjectId> all(order.order);
  LayerImage image;
  renderer.draw(view, all.first(order.first_blended), {.depths = true}, image);
  const std::vector<float> opaque = image.depths;
  std::vector<SeenDepths> seen;  // in the order of drawing
  for (const ObjectId& id : all.subspan(order.first_blended)) {
    renderer.draw(view, {&id, 1}, {.depths = true}, image);
    seen.push_back(seenDepths(image, opaque));
  }
  DistancePairs pairs;
  for (std::size_t later = 0; later < seen.size(); ++later) {
    for (std::size_t earlier = 0; earlier < later; ++earlier) {
      const PairLook found = look(seen[earlier], seen[later]);
      pairs.overlapping += found.overlap ? 1 : 0;
      pairs.wrong += found.first_before ? 1 : 0;
      pairs.without_order += found.first_before && found.second_before ? 1 : 0;
    }
  }
  return pairs;
}

void drawByDistance(LayerRenderer& renderer, const View& view, const DistanceOrder& order,
                    LayerImage& image) {
  renderer.draw(view, order.order, {.as_given = true}, image);
}

}  // namespace sightline::tool
