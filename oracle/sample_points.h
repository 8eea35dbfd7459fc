#pragma once

// Points of objects that rays are aimed at.

#include <cstdint>
#include <vector>

#include "sightline/scene/scene.h"

namespace sightline {

class SamplePoints {
 public:
  // The scene's memory must outlive this. 4 bytes a triangle.
  explicit SamplePoints(const SceneView& scene);

  // Point number `sample` of an object as seen by a view: its triangle chosen by area, one that shows its
  // front if some tries find one; the place in turn any on its face, just inside a corner, just inside an
  // edge. The same arguments give the same point. Precondition: the object has triangles.
  Vec3d point(ObjectId object, std::uint32_t sample, const View& view) const;
  // A point close beside an edge of one of its triangles, as the view sees it: to the left or the right of
  // it, by 1e-7 to 1e-2 of the distance. What shows there shows at a silhouette or through a gap, if the edge
  // is part of one.
  Vec3d besideEdge(ObjectId object, std::uint32_t sample, const View& view) const;

 private:
  struct Triangle {
    Vec3d a, b, c;
  };
  Triangle triangle(const Object& object, std::uint32_t index) const;
  std::uint32_t triangleAt(const Object& object, double share) const;

  SceneView scene_;
  std::vector<float> area_share_;  // of the object's area, in its triangles up to this one
};

}  // namespace sightline
