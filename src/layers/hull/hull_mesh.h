#pragma once

// The surface of the convex hull of points that fill space, as triangles that know their neighbours: convex
// without rounding, for on which side of a triangle a point lies is told exactly.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sightline/math/vec3.h"
#include "src/layers/hull/hull_frame.h"

namespace sightline::layers {

class HullMesh {
 public:
  struct Facet {
    std::array<std::uint32_t, 3> corner{};  // points, counter-clockwise from outside
    std::array<std::uint32_t, 3> across{};  // the facet beyond the edge from corner i to corner i + 1
    Vec3d normal;                           // unit, outwards, rounded
    bool live = true;
    bool visible = false;
    std::vector<std::uint32_t> outside;  // points above it that are not in the mesh yet
  };

  // The hull of some points (coordinates of at most 1), leaving out what is not above it by more than the
  // frame's tolerance. frame: of these points, dimension 3. The points must outlive the mesh.
  HullMesh(std::span<const Vec3d> points, std::span<const std::uint32_t> chosen, const HullFrame& frame);

  // False: the frame's corners lie in a plane after all, there is no mesh.
  bool valid() const { return !facets_.empty(); }
  // Makes the mesh the hull of itself and a point; nothing if that is not above the facet, a live one.
  void insert(std::uint32_t point, std::uint32_t facet);

  const std::vector<Facet>& facets() const { return facets_; }
  // Positive: the point is above the facet. Exact in sign.
  double above(const Facet& facet, const Vec3d& point) const;
  // Whether the surface bends at the edge from corner i to the next, or is flat there. Exact.
  bool bends(const Facet& facet, std::size_t i) const;
  const Vec3d& at(std::uint32_t point) const { return points_[point]; }

 private:
  void makeSimplex(const std::array<std::uint32_t, 4>& corners);
  std::uint32_t addFacet(const std::array<std::uint32_t, 3>& corner);
  void assign(std::uint32_t point, std::uint32_t first_facet);
  std::uint32_t farthestOutside(const Facet& facet) const;
  void findVisible(std::uint32_t point, std::uint32_t facet);
  void addCone(std::uint32_t point);

  std::span<const Vec3d> points_;
  Vec3d middle_;
  double tolerance_ = 0.0;
  std::vector<Facet> facets_;
  std::vector<std::uint32_t> visible_;   // facets that the point sees that is being inserted
  std::vector<std::uint32_t> facet_of_;  // by point: the new facet whose first corner it is
};

}  // namespace sightline::layers
