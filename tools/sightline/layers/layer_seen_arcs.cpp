#include "tools/sightline/layers/layer_seen_arcs.h"

#include <algorithm>
#include <utility>

namespace sightline::tool {
namespace {

constexpr std::size_t kFewArcs = 1 << 16;

}  // namespace

Result<SeenArcs> SeenArcs::create(const FrameMakerInput& input) {
  Result<LayerRenderer> renderer = makeRenderer(input);
  if (!renderer) {
    return renderer.error();
  }
  return SeenArcs(input, std::move(*renderer));
}

const LayerOrder& SeenArcs::sort(const View& view, const LayerOrder& order,
                                 std::span<const Mat4> scene_from_stored) {
  renderer_.setTransforms(scene_from_stored);
  arcs_.clear();
  std::size_t most = kFewArcs;
  cover(view, order);
  for (auto first = covers_.begin(); first != covers_.end();) {
    const auto end =
        std::find_if(first, covers_.end(), [&](const Cover& cover) { return cover.pixel != first->pixel; });
    addArcsOfPixel(std::span(first, end), order);
    if (arcs_.size() > most) {  // most pixels repeat what others say
      std::sort(arcs_.begin(), arcs_.end());
      arcs_.erase(std::unique(arcs_.begin(), arcs_.end()), arcs_.end());
      most = std::max(kFewArcs, 2 * arcs_.size());
    }
    first = end;
  }
  return sorter_.sort(order, arcs_);
}

bool SeenArcs::isSeeThrough(std::uint32_t part) const {
  return scene_.materialOf(scene_.objects[part]).opacity == Opacity::kBlended;
}

// Draws each sorted part alone and lists the pixels that it covers, then brings those of a pixel together,
// from the nearest to the farthest.
void SeenArcs::cover(const View& view, const LayerOrder& order) {
  covers_.clear();
  for (std::size_t i = order.first_sorted; i < order.sorted_end; ++i) {
    for (const PartId part : order.group(i)) {
      const ObjectId object(part.value);
      renderer_.draw(view, {&object, 1}, {.depths = true}, image_);
      for (std::uint32_t pixel = 0; pixel < image_.depths.size(); ++pixel) {
        if (image_.depths[pixel] != LayerImage::kNoDepth) {
          covers_.push_back({pixel, image_.depths[pixel], part.value});
        }
      }
    }
  }
  std::sort(covers_.begin(), covers_.end());
}

void SeenArcs::addArcsOfPixel(std::span<const Cover> covers, const LayerOrder& order) {
  const auto nearest = std::find_if(covers.begin(), covers.end(),
                                    [&](const Cover& cover) { return !isSeeThrough(cover.part); });
  const auto unhidden_end = nearest == covers.end() ? covers.end() : nearest + 1;
  for (auto a = covers.begin(); a != unhidden_end; ++a) {
    for (auto b = a + 1; b != unhidden_end; ++b) {
      addHullArcs(a->part, b->part, order);
    }
  }
  for (auto hidden = unhidden_end; hidden != covers.end(); ++hidden) {
    add(nearest->part, hidden->part);
  }
}

// At least one arc is there, since each of the two hulls covers the pixel.
void SeenArcs::addHullArcs(std::uint32_t a, std::uint32_t b, const LayerOrder& order) {
  for (const LayerArc& arc : {LayerArc{PartId(a), PartId(b)}, LayerArc{PartId(b), PartId(a)}}) {
    if (std::binary_search(order.arcs.begin(), order.arcs.end(), arc)) {
      add(arc.front.value, arc.back.value);
    }
  }
}

void SeenArcs::add(std::uint32_t front, std::uint32_t back) {
  arcs_.push_back({PartId(front), PartId(back)});
}

}  // namespace sightline::tool
