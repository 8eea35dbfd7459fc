#pragma once

// The order of a painted drawing by what is seen.
//
// Where an object is seen it must be painted after all that it hides there; the order of what is hidden does
// not matter, since it is painted over. So of the arcs of hulls only those from an object that may be seen to
// what may lie behind it there are needed. An object is certainly not seen where the outline of another
// covers it whose hull is in front of its own, and not behind. Everything that is left out is certain, up to
// the grid on which outlines lie: an object may still count as seen that is not.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "sightline/layers/arc_order.h"
#include "sightline/scene/scene.h"
#include "src/drawing/outline.h"

namespace sightline::drawing {

class SeenOrder {
 public:
  // The outline of an object as it is painted, on the outliner's grid; empty: it hides nothing.
  using OutlineOf = std::function<const std::vector<GridPath>&(ObjectId object)>;

  // Returns the order by the arcs that are needed; valid until the next call and no longer than `order`,
  // which must have the arcs of all pairs. Part i is object i. The order itself, if no group has several
  // parts.
  const LayerOrder& sort(const SceneView& scene, const Outliner& outliner, const LayerOrder& order,
                         const OutlineOf& outline_of);

 private:
  // What may be seen of an object: pieces of its image, as boxes on the grid.
  struct GridBox {
    GridPoint low, high;
  };

  void addArcsOf(ObjectId front, const Outliner& outliner, const LayerOrder& order,
                 const OutlineOf& outline_of);
  std::vector<GridBox> seenBoxes(ObjectId object, const Outliner& outliner, const LayerOrder& order,
                                 const OutlineOf& outline_of) const;
  std::vector<ObjectId> certainlyInFront(ObjectId object, const LayerOrder& order) const;
  static GridBox boxOf(const GridPath& path);
  static bool overlap(const GridBox& a, const GridBox& b);

  ArcSorter sorter_;
  std::vector<LayerArc> arcs_;
  std::vector<std::vector<ObjectId>> fronts_, backs_;  // one list per object, by the arcs of hulls
  std::vector<std::uint32_t> group_of_;                // one per object
  std::vector<GridPath> images_;                       // one per object: a convex ring around its image
  std::vector<GridBox> boxes_;                         // of the images
};

}  // namespace sightline::drawing
