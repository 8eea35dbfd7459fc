#pragma once

// The surface of the convex hull of points that span space, as triangles with neighbours. It is exactly
// convex, since the side of a triangle on which a point lies is computed exactly.

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
    std::array<std::uint32_t, 3> corner{};  // points, counter-clockwise seen from outside
    std::array<std::uint32_t, 3> across{};  // the facet beyond the edge from corner i to corner i + 1
    Vec3d normal;                           // outward unit normal, rounded
    bool live = true;
    bool visible = false;
    std::vector<std::uint32_t> outside;  // points above it that are not in the mesh yet
  };

  // Makes the hull of the chosen points, without those that are not above it by more than the frame's
  // tolerance.
  // points: coordinates of at most 1; they must outlive the mesh. frame: that of the chosen points, of
  // dimension 3.
  HullMesh(std::span<const Vec3d> points, std::span<const std::uint32_t> chosen, const HullFrame& frame);

  // Returns false if the frame's corners turn out to lie in a plane, so that there is no mesh.
  bool valid() const { return !facets_.empty(); }
  // Extends the mesh to the hull of itself and a point; does nothing if the point is not above the given live
  // facet.
  void insert(std::uint32_t point, std::uint32_t facet);

  const std::vector<Facet>& facets() const { return facets_; }
  // Returns a positive number if the point is above the facet. The sign is exact.
  double above(const Facet& facet, const Vec3d& point) const;
  // Whether the surface bends at the edge from corner i to the next one; exact.
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
  std::vector<std::uint32_t> visible_;   // facets visible from the point that is being inserted
  std::vector<std::uint32_t> facet_of_;  // one per point: the new facet of which it is the first corner
};

}  // namespace sightline::layers
