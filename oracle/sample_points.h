#pragma once

// Points on objects at which rays are aimed.

#include <cstdint>
#include <vector>

#include "sightline/scene/scene.h"

namespace sightline {

class SamplePoints {
 public:
  // The scene's memory must outlive this object. Takes 4 bytes per triangle.
  explicit SamplePoints(const SceneView& scene);

  // Sample number `sample` of an object as seen by a view. The triangle is chosen by area, and preferably
  // shows its front. The samples alternate between points anywhere on the face, just inside a corner, and
  // just inside an edge. The same arguments give the same point. The object must have triangles.
  Vec3d point(ObjectId object, std::uint32_t sample, const View& view) const;
  // A point close beside an edge of one of the object's triangles as the view sees it: to the left or right,
  // by 1e-7 to 1e-2 of the distance. If the edge is part of a silhouette or of a gap, a ray through this
  // point passes it closely.
  Vec3d besideEdge(ObjectId object, std::uint32_t sample, const View& view) const;

 private:
  struct Triangle {
    Vec3d a, b, c;
  };
  Triangle triangle(const Object& object, std::uint32_t index) const;
  std::uint32_t triangleAt(const Object& object, double share) const;

  SceneView scene_;
  std::vector<float> area_share_;  // cumulative fraction of the object's area in its triangles up to this one
};

}  // namespace sightline
