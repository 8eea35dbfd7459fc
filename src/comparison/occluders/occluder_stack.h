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

// The nodes that are occludees, ascending: on each way down the first node with at most max_triangles, or the
// leaf, if it has more than min_triangles and its box is sound.
std::vector<NodeIndex> findOccludees(const Hierarchy& hierarchy, std::uint32_t min_triangles,
                                     std::uint32_t max_triangles);

// Finds the nodes that are in the picture and wholly beyond its near plane, in the order given.
void occludeesInPicture(const Hierarchy& hierarchy, std::span<const NodeIndex> nodes,
                        const scene::PixelView& view, std::uint32_t resolution, std::vector<Occludee>& found);

// Whether each pixel of the occludee's rectangle has an occluder in front of it. The look begins at
// first_pixel; if the answer is no, first_pixel becomes a pixel that has none.
bool hides(const IdBuffer& buffer, std::uint32_t resolution, const Occludee& occludee,
           std::uint32_t& first_pixel);

// The stacks of several occludees, made at once: in each pixel, the occluders in front of an occludee are a
// prefix of all layers of that pixel, of which the 64 nearest are kept. Keeps its storage.
class OccluderStack {
 public:
  // nearest: of all occluders of the picture. Only occludees that it hides have a table.
  void build(const OccluderPicture& picture, const IdBuffer& nearest, std::span<const Occludee> occludees);

  // Numbers of the occludees that all occluders together hide, ascending.
  std::span<const std::uint32_t> hidden() const { return hidden_; }

  // Fills the table of a hidden occludee; its occluders are numbers in the picture.
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
