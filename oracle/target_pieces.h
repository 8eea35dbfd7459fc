#pragma once

// What of an object's triangles lies in a box, for RegionProof: polygons that are cut by planes across the
// axes.

#include <cstdint>
#include <vector>

#include "oracle/region_hull.h"
#include "sightline/scene/scene.h"

namespace sightline {

class TargetPieces {
 public:
  // All triangles of the object.
  TargetPieces(const SceneView& scene, ObjectId object);

  bool empty() const { return ends_.empty(); }
  // A box around all pieces, wider than rounding may move them. There must be some.
  DoubleBox bounds() const;
  // What lies on one side of a plane across an axis: the two halves hold all points of the pieces.
  TargetPieces half(int axis, double level, bool above) const;

 private:
  explicit TargetPieces(double margin) : margin_(margin) {}
  void addCut(std::uint32_t begin, std::uint32_t end, int axis, double level, bool above,
              TargetPieces& pieces) const;

  double margin_ = 0.0;  // metres; a corner is off by less, however often pieces are cut
  std::vector<Vec3d> corners_;
  std::vector<std::uint32_t> ends_;  // of each polygon, in corners_
};

}  // namespace sightline
