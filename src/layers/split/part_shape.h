#pragma once

// The shape of a part or of a piece of one, which planes divide.

#include <cstddef>
#include <optional>
#include <vector>

#include "sightline/layers/hull.h"
#include "sightline/math/plane.h"
#include "src/layers/hull/hull_box.h"
#include "src/layers/hull/hull_envelope.h"
#include "src/layers/pairs/convex_pair.h"

namespace sightline::layers {

using ShapePolygon = std::vector<Vec3d>;

// Polygons that are taken together as their convex hull: a mesh, or the surface of a convex part.
struct ShapeBody {
  std::vector<ShapePolygon> polygons;
  // Stands for the hull of the polygons' corners. While halves are tried, it is a cloud of corners without
  // edges, and of very many corners only some of the outermost.
  ConvexHull hull;
  HullBox box;
  HullEnvelope envelope;
  double slack = 0.0;  // by which cuts may have moved corners
};

// A union of bodies, in the part's space.
struct PartShape {
  std::vector<ShapeBody> bodies;
  double surface = 0.0;  // of the bodies' boxes

  std::size_t polygons() const;
  // The bodies' hulls placed in the world, made smaller by half the erosion; valid as long as this shape.
  std::vector<ConvexSet> placed(const Placement& placement, double erosion) const;
};

double surfaceOf(const HullBox& box);

// Adds a body of these polygons, or of the surface of a hull.
void addBody(std::vector<ShapePolygon> polygons, PartShape& shape);
void addBody(const ConvexHull& hull, PartShape& shape);

struct ShapeHalves {
  PartShape front, behind;  // `front` is the side to which the plane's normal points
};
// Divides a shape by a plane, for a trial. Nothing if all of the shape lies on one side.
std::optional<ShapeHalves> halvesOf(const PartShape& shape, const Plane& plane);

// Builds the hulls of a shape that was on trial. Every point of the shape is in one of them. False if there
// is no memory.
bool buildHulls(PartShape& shape);

}  // namespace sightline::layers
