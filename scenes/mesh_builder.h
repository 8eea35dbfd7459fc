#pragma once

// The primitives of all procedural scenes. Coordinates are in the current placement; triangles are
// counter-clockwise as seen from outside. Within one call, adjacent faces share their vertices exactly.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "scenes/placement.h"
#include "sightline/scene/scene.h"

namespace sightline::scenes {

// The faces of a box or of a prism: bottom and top are its two ends along z.
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

// Corners of a rectangle, counter-clockwise.
std::vector<Point2> corners(const Rectangle& rectangle);
// The polygon with every edge moved outwards by distance (inwards if negative); counter-clockwise, like the
// input.
std::vector<Point2> outset(std::span<const Point2> outline, double distance);
// Triangulates a simple counter-clockwise polygon by ear clipping. Returns indices into the outline.
std::vector<std::uint32_t> triangulate(std::span<const Point2> outline);

class MeshBuilder {
 public:
  // Appends to the scene, which must outlive the builder.
  explicit MeshBuilder(Scene& scene) : scene_(scene) {}
  ~MeshBuilder() { finishObject(); }
  MeshBuilder(const MeshBuilder&) = delete;
  MeshBuilder& operator=(const MeshBuilder&) = delete;

  // Starts a new object for the triangles that follow. An object without triangles is dropped.
  void startObject(std::string name, MaterialId material);
  void finishObject();
  void place(const Placement& placement) { placement_ = placement; }
  std::uint64_t triangleCount() const { return scene_.triangleCount(); }

  void triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c);
  void quad(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d);
  void box(const Vec3d& low, const Vec3d& high, std::uint32_t faces = kAllFaces);
  // A simple counter-clockwise polygon in the xy plane, extruded from z0 to z1 (with all sides or none).
  void prism(std::span<const Point2> outline, double z0, double z1, std::uint32_t faces = kAllFaces);
  // The region between two polygons with equal numbers of corners, the inner one inside the outer one,
  // extruded.
  void ring(std::span<const Point2> outer, std::span<const Point2> inner, double z0, double z1,
            std::uint32_t faces = kAllFaces);
  // A surface of revolution: a profile of (radius, z), its outside on the right, about the z axis. Radius 0
  // makes a pole.
  void lathe(std::span<const Point2> profile, std::uint32_t segments);
  // A rectangle with rectangular openings that do not overlap, from z0 to z1. Consists of a grid of coplanar
  // quads cut at every edge of an opening, so that all vertices are shared.
  void plate(const Rectangle& area, double z0, double z1, std::span<const Rectangle> openings,
             std::uint32_t faces = kAllFaces);
  // Any mesh: three indices into the points per triangle.
  void mesh(std::span<const Vec3d> points, std::span<const std::uint32_t> indices);
  // A closed tube through rings of `corners` points each, which follow one another in `points`, bottom first;
  // each ring is counter-clockwise as seen from the end. The first and the last ring are closed by fans
  // about their centres.
  void tube(std::span<const Vec3d> points, std::uint32_t corners);
  // A closed roof over a rectangle. The ridge runs along the longer side, inset at both ends (0: gables).
  void ridgeRoof(const Rectangle& area, double z0, double rise, double ridge_inset);

 private:
  std::uint32_t vertex(const Vec3d& p);
  void face(std::uint32_t a, std::uint32_t b, std::uint32_t c);

  Scene& scene_;
  Placement placement_;
};

}  // namespace sightline::scenes
