// How far outside a convex mesh points are.
//
// Let c be inside and x above the plane of a facet by a volume V > 0, where c is below it by W > 0 (six times
// the tetrahedra over the facet). The segment from c to x crosses that plane at c + (x - c) W / (V + W),
// which is |x - c| V / (V + W) before x. Where the segment leaves the mesh it crosses the plane of the facet
// there, and the point where it does belongs to the hull: so x is no farther from the hull than the greatest
// of these values over the facets below it. Volumes are good to 2 %.

#include "src/layers/hull/hull_excess.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace sightline::layers {
namespace {

// A plane that tells quickly that a point is behind a facet.
struct Behind {
  Vec3d normal;
  double offset = 0.0;  // the height above `inside` up to which a point is certainly behind the facet
  std::uint32_t facet = 0;
};

// The normal is off by at most 8 e |u| |v| / |u x v|, e = 2^-53, for sides u and v, and by rounding to unit
// length; heights by that times the distance, and by their own rounding.
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
  HullExcess worst;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const Vec3d from_inside = points[i] - inside;
    if (length(from_inside) * (1.0 + 0x1p-40) < all_behind) {
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
