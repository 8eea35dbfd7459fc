#pragma once

// `layers --arcs seen`: arcs from what a picture shows to what lies behind it.

#include <cstdint>
#include <vector>

#include "sightline/layers/arc_order.h"
#include "sightline/render/layer_renderer.h"
#include "tools/sightline/layers/layer_frames.h"

namespace sightline::tool {

// Opaque parts need an order only where one is seen: it must be drawn after all that it hides there, whose
// own order does not matter. So each part is drawn alone, and the nearest opaque one of a pixel gets arcs to
// all others that cover the pixel farther away. See-through parts of a pixel that nothing hides keep the
// hulls' arcs between themselves and the nearest opaque part. Approximate at a pixel: an occlusion that no
// sample shows has no arc, and of several samples in a pixel only the nearest counts.
class SeenArcs {
 public:
  static Result<SeenArcs> create(const FrameMakerInput& input);

  // Returns the order by what is seen; valid until the next call, and no longer than `order`.
  // order: of the parts' hulls, with all arcs. scene_from_stored: as SortedFrame's.
  const LayerOrder& sort(const View& view, const LayerOrder& order, std::span<const Mat4> scene_from_stored);

 private:
  // A part that covers a pixel.
  struct Cover {
    std::uint32_t pixel = 0;
    float depth = 0.0f;
    std::uint32_t part = 0;
    friend auto operator<=>(const Cover&, const Cover&) = default;
  };

  SeenArcs(const FrameMakerInput& input, LayerRenderer renderer)
      : scene_(input.input.moving.scene.view()), renderer_(std::move(renderer)) {}
  bool isSeeThrough(std::uint32_t part) const;
  void cover(const View& view, const LayerOrder& order);
  void addArcsOfPixel(std::span<const Cover> covers, const LayerOrder& order);
  void addHullArcs(std::uint32_t a, std::uint32_t b, const LayerOrder& order);
  void add(std::uint32_t front, std::uint32_t back);

  SceneView scene_;
  LayerRenderer renderer_;
  ArcSorter sorter_;
  LayerImage image_;
  std::vector<Cover> covers_;   // as many as pixels times the parts that cover one, on average
  std::vector<LayerArc> arcs_;  // in any order, some more than once
};

}  // namespace sightline::tool
