#pragma once

// A section of the scene: a plane, with what it cuts of a region, of an object and of all that may hide it.

#include <optional>
#include <span>
#include <vector>

#include "oracle/eye_region.h"
#include "oracle/plane_lines.h"
#include "oracle/triangle_tree.h"

namespace sightline {

class PlaneSection {
 public:
  // The plane through `eye` and `target`, which is x = 0, y = 0 and the direction of x, and parallel to
  // `across`. Nothing if they do not span a plane.
  static std::optional<PlaneSection> through(const Vec3d& eye, const Vec3d& target, const Vec3d& across);

  // Cuts everything. What is within near_distance of the region does not block.
  void cut(const SceneView& scene, const TriangleTree& tree, const EyePlaces& places, ObjectId object,
           double near_distance);

  Vec3d inSpace(const PlanePoint& p) const { return origin_ + x_axis_ * p.x + y_axis_ * p.y; }

  std::span<const Gate> exits() const { return exits_; }        // of lines that leave the region
  std::span<const Gate> targets() const { return targets_; }    // of lines that reach the object's surface
  std::span<const Gate> blockers() const { return blockers_; }  // opaque surfaces of other objects

 private:
  PlaneSection() = default;

  PlanePoint inPlane(const Vec3d& p) const { return {dot(p - origin_, x_axis_), dot(p - origin_, y_axis_)}; }
  void cutRegion(const EyePlaces& places);
  bool mayCut(const Box& box) const;
  void cutTriangle(const SceneView& scene, const TriangleTree::Node& leaf, std::vector<Gate>& gates) const;
  // Appends the parts of a gate that are farther than near_distance from the region.
  void keepBeyondNear(const Gate& gate, double near_distance);

  Vec3d origin_{}, x_axis_{}, y_axis_{}, normal_{};
  std::vector<PlanePoint> outline_;  // of the region, counter-clockwise
  std::vector<Gate> exits_, targets_, blockers_;
};

}  // namespace sightline
