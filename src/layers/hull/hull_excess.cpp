// The distance of points outside a convex mesh.
//
// Let c be a point inside, and x a point above the plane of a facet. Let V > 0 and W > 0 be six times the
// volumes of the tetrahedra of the facet with x and with c. The segment from c to x crosses the plane at c +
// (x - c) W / (V + W), at the distance |x - c| V / (V + W) from x. Where the segment leaves the mesh, it
// crosses the plane of the facet there, at a point of the hull. So the distance of x from the hull is at most
// the greatest of these values over the facets that x is above. Volumes are within 2 %.

#include "src/layers/hull/hull_excess.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace sightline::layers {
namespace {

// A plane for a quick test of whether a point is behind a facet.
struct Behind {
  Vec3d normal;
  double offset = 0.0;  // points up to this height above `inside` are certainly behind the facet
  std::uint32_t facet = 0;
};

// The error of the normal is at most 8 e |u| |v| / |u x v| for sides u and v, e = 2^-53, plus the rounding to
// unit length. The error of a height is that times the distance, plus its own rounding.
std::vector<Behind> quickPlanes(const HullMesh& mesh, const Vec3d& inside, double reach) {
  std::vector<Behind> planes;
  for (std::uint32_t i = 0; i < mesh.facets().size(); ++i) {
    const HullMesh::Facet& facet = mesh.facets()[i];
    if (!facet.live) {
      continue;
    }
    const Vec3d a = mesh.at(facet.corner[0]);
    const Vec3d u = mesh.at(facet.corner[1]) - a;
    const Vec3d v = mesh.at(facet.corner[2]) - a;
    const double tilt = 0x1p-49 * (1.0 + length(u) * length(v) / length(cross(u, v)));
    planes.push_back({facet.normal, dot(facet.normal, a - inside) - 4.0 * tilt * reach, i});
  }
  return planes;
}

bool isBefore(const Vec3d& a, const Vec3d& b) {
  return std::array{a.x, a.y, a.z} < std::array{b.x, b.y, b.z};
}

// Returns where the mesh has corners, in order. The mesh is exactly convex, so no point there is above it. To
// compare all corners with all facets would take time quadratic in their number, and in a round mesh each
// point is a corner or a copy of one.
std::vector<Vec3d> sortedCorners(const HullMesh& mesh) {
  std::vector<Vec3d> corners;
  for (const HullMesh::Facet& facet : mesh.facets()) {
    for (std::size_t i = 0; facet.live && i < 3; ++i) {
      corners.push_back(mesh.at(facet.corner[i]));
    }
  }
  std::sort(corners.begin(), corners.end(), isBefore);
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  return corners;
}

}  // namespace

HullExcess hullExcess(const HullMesh& mesh, std::span<const Vec3d> points, const Vec3d& inside) {
  double reach = 0.0;
  for (const Vec3d& p : points) {
    reach = std::max(reach, length(p - inside));
  }
  const std::vector<Behind> planes = quickPlanes(mesh, inside, reach);
  double all_behind = reach;  // points nearer than this are behind all planes
  for (const Behind& plane : planes) {
    all_behind = std::min(all_behind, plane.offset);
  }
  const std::vector<Vec3d> corners = sortedCorners(mesh);
  HullExcess worst;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const Vec3d from_inside = points[i] - inside;
    if (length(from_inside) * (1.0 + 0x1p-40) < all_behind ||
        std::binary_search(corners.begin(), corners.end(), points[i], isBefore)) {
      continue;
    }
    for (const Behind& plane : planes) {
      if (dot(plane.normal, from_inside) < plane.offset) {
        continue;
      }
      const HullMesh::Facet& facet = mesh.facets()[plane.facet];
      const double above = mesh.above(facet, points[i]);
      if (!(above > 0.0)) {
        continue;
      }
      const double below = -mesh.above(facet, inside);
      const double distance = 1.05 * length(from_inside) * (above / (above + below));
      if (distance > worst.distance) {
        worst = {i, plane.facet, distance};
      }
    }
  }
  return worst;
}

bool strictlyInside(const HullMesh& mesh, const Vec3d& point) {
  for (const HullMesh::Facet& facet : mesh.facets()) {
    if (facet.live && !(mesh.above(facet, point) < 0.0)) {
      return false;
    }
  }
  return true;
}

}  // namespace sightline::layers
