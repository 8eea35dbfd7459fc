#pragma once

// The primitives that every procedural scene is made of. Coordinates are those of the current placement;
// triangles come out counter-clockwise seen from outside. Within one call, faces that meet share their
// vertices exactly.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "scenes/placement.h"
#include "sightline/scene/scene.h"

namespace sightline::scenes {

// The faces of a box, or of an extruded figure: bottom and top are its two ends along z.
enum Faces : std::uint32_t {
  kWest = 1,
  kEast = 2,
  kSouth = 4,
  kNorth = 8,
  kBottom = 16,
  kTop = 32,
  kSides = kWest | kEast | kSouth | kNorth,
  kAllFaces = kSides | kBottom | kTop,
  kNoBottom = kSides | kTop,
};

struct Rectangle {
  Point2 min, max;
  constexpr bool contains(Point2 p) const {
    return min.x <= p.x && p.x <= max.x && min.y <= p.y && p.y <= max.y;
  }
};

// Corners of a rectangle, anticlockwise.
std::vector<Point2> corners(const Rectangle& rectangle);
// The figure with every edge moved outwards by distance (inwards when negative); anticlockwise, as given.
std::vector<Point2> outset(std::span<const Point2> outline, double distance);
// Triangles (indices into the outline) that fill a simple anticlockwise figure, by clipping ears.
std::vector<std::uint32_t> triangulate(std::span<const Point2> outline);

class MeshBuilder {
 public:
  // Appends to the scene, which outlives the builder.
  explicit MeshBuilder(Scene& scene) : scene_(scene) {}
  ~MeshBuilder() { finishObject(); }
  MeshBuilder(const MeshBuilder&) = delete;
  MeshBuilder& operator=(const MeshBuilder&) = delete;

  // What follows belongs to a new object. An object without triangles is left out.
  void startObject(std::string name, MaterialId material);
  void finishObject();
  void place(const Placement& placement) { placement_ = placement; }
  std::uint64_t triangleCount() const { return scene_.triangleCount(); }

  void triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c);
  void quad(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d);
  void box(const Vec3d& low, const Vec3d& high, std::uint32_t faces = kAllFaces);
  // A simple anticlockwise figure in the xy plane, drawn out from z0 to z1 (all sides or none).
  void prism(std::span<const Point2> outline, double z0, double z1, std::uint32_t faces = kAllFaces);
  // What lies between two figures of equally many corners, the inner inside the outer.
  void ring(std::span<const Point2> outer, std::span<const Point2> inner, double z0, double z1,
            std::uint32_t faces = kAllFaces);
  // A profile of (radius, z), outside on the right, turned about the z axis. Radius 0 makes a pole.
  void lathe(std::span<const Point2> profile, std::uint32_t segments);
  // A rectangle with rectangular openings that do not overlap, from z0 to z1. Made of a grid of coplanar
  // quads, cut at every edge of an opening, so that all vertices are shared.
  void plate(const Rectangle& area, double z0, double z1, std::span<const Rectangle> openings,
             std::uint32_t faces = kAllFaces);
  // A roof over a rectangle: the ridge runs along the longer side, inset at both ends (0: gables). Closed.
  void ridgeRoof(const Rectangle& area, double z0, double rise, double ridge_inset);

 private:
  std::uint32_t vertex(const Vec3d& p);
  void face(std::uint32_t a, std::uint32_t b, std::uint32_t c);

  Scene& scene_;
  Placement placement_;
};

}  // namespace sightline::scenes
