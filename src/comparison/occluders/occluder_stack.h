#pragma once

// The occluder stack: for every pixel of an occludee's image, the occluders in front of it.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/hierarchy/hierarchy.h"
#include "src/comparison/occluders/id_buffer.h"
#include "src/comparison/occluders/minimum_sets.h"
#include "src/comparison/occluders/occluder_picture.h"

namespace sightline::comparison {

// Pixels with left <= x < right and low <= y < high.
struct PixelRect {
  std::uint32_t left = 0, low = 0, right = 0, high = 0;
  friend bool operator==(const PixelRect&, const PixelRect&) = default;
};

// A node of a hierarchy as it lies in a picture.
struct Occludee {
  NodeIndex node;
  PixelRect rect;                 // around its image, cut off at the picture's border; not empty
  float reciprocal_depth = 0.0f;  // an occluder in front of it is nearer than this
};

// The nodes that are occludees: with more than min_triangles, and the first ones on the way down with at most
// max_triangles, or leaves. Without those whose box is broken. Ascending.
std::vector<NodeIndex> findOccludees(const Hierarchy& hierarchy, std::uint32_t min_triangles,
                                     std::uint32_t max_triangles);

// Those of the nodes that are in the picture and wholly beyond its near plane, in the same order.
void occludeesInPicture(const Hierarchy& hierarchy, std::span<const NodeIndex> nodes, const PixelView& view,
                        std::uint32_t resolution, std::vector<Occludee>& found);

// Whether each pixel of the occludee's rectangle has something in front of it. first_pixel: where to begin to
// look; when the answer is no, a pixel that has nothing.
bool hides(const IdBuffer& buffer, std::uint32_t resolution, const Occludee& occludee,
           std::uint32_t& first_pixel);

// The stacks of several occludees, of which those of all pixels are made at once: what is in front of an
// occludee in a pixel are the first ones of all layers of that pixel (of which it has the 64 nearest). Keeps
// its storage.
class OccluderStack {
 public:
  // nearest: all occluders of the picture. Of the occludees only those that it hides have a table.
  void build(const OccluderPicture& picture, const IdBuffer& nearest, std::span<const Occludee> occludees);

  // Numbers of the occludees that all occluders together hide, ascending.
  std::span<const std::uint32_t> hidden() const { return hidden_; }

  // The occludee's slots: occluders by number in the picture. Only for hidden ones.
  void tableOf(const Occludee& occludee, CombinationTable& table);

 private:
  // An occluder in a pixel, as one number: ascending is from near to far, of equal ones by occluder.
  static std::uint64_t layerOf(float reciprocal_depth, std::uint32_t occluder);
  void addLayer(std::uint32_t pixel, std::uint64_t layer);
  // The occluders in front of the reciprocal depth in a pixel, from near to far.
  void layersBefore(std::uint32_t pixel, float reciprocal_depth, std::vector<std::uint32_t>& occluders) const;

  std::uint32_t resolution_ = 0;
  std::vector<std::uint32_t> hidden_;
  std::vector<float> farthest_;                   // by pixel: what is not nearer is of no use to any occludee
  std::vector<std::uint32_t> first_of_, end_of_;  // by pixel, into layers_
  std::vector<std::uint64_t> layers_;
  std::vector<std::uint32_t> here_, left_;  // scratch: members of a pixel, and of the one on its left
  std::vector<std::vector<std::uint32_t>> below_;
};

}  // namespace sightline::comparison
