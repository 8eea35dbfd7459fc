// Based on: Barber, Dobkin, Huhdanpaa. The Quickhull algorithm for convex hulls. ACM TOMS 1996.
// Differs from the paper in: visibility of facets is exact, so facets need not be merged; the choice of
// points to insert, and the facet that they are kept with, are subject to rounding.
//
// The facets that a point sees strictly are a connected part of the surface whose border is one closed line.
// No new facet is degenerate, since a point in line with an edge of the border would lie in the plane of the
// visible facet there.

#include "src/layers/hull/hull_mesh.h"

#include <algorithm>
#include <utility>

#include "src/layers/pairs/exact_volume.h"

namespace sightline::layers {
namespace {

// The normal of three points that are not exactly in line. If they are nearly in line, the exact areas of
// their projections are used.
Vec3d normalOf(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  constexpr double kNearlyInLine = 0x1p-30;
  const Vec3d normal = cross(b - a, c - a);
  if (length(normal) > kNearlyInLine * length(b - a) * length(c - a)) {
    return normalized(normal);
  }
  return normalized(Vec3d{exactArea(a.y, a.z, b.y, b.z, c.y, c.z), exactArea(a.z, a.x, b.z, b.x, c.z, c.x),
                          exactArea(a.x, a.y, b.x, b.y, c.x, c.y)});
}

}  // namespace

HullMesh::HullMesh(std::span<const Vec3d> points, std::span<const std::uint32_t> chosen,
                   const HullFrame& frame)
    : points_(points), middle_(frame.middle), tolerance_(frame.tolerance), facet_of_(points.size()) {
  makeSimplex(frame.corners);
  if (!valid()) {
    return;
  }
  for (const std::uint32_t point : chosen) {
    assign(point, 0);
  }
  // New facets are appended, and facets already visited have no points left.
  for (std::uint32_t facet = 0; facet < facets_.size(); ++facet) {
    while (facets_[facet].live && !facets_[facet].outside.empty()) {
      const std::uint32_t point = farthestOutside(facets_[facet]);
      insert(point, facet);
      if (facets_[facet].live) {  // the point is not outside; its height was rounding error
        std::erase(facets_[facet].outside, point);
      }
    }
  }
}

double HullMesh::above(const Facet& facet, const Vec3d& point) const {
  return exactVolume(at(facet.corner[0]), at(facet.corner[1]), at(facet.corner[2]), point);
}

bool HullMesh::bends(const Facet& facet, std::size_t i) const {
  const Facet& other = facets_[facet.across[i]];
  const std::uint32_t a = facet.corner[i];
  const std::uint32_t b = facet.corner[(i + 1) % 3];
  for (const std::uint32_t corner : other.corner) {
    if (corner != a && corner != b) {
      return above(facet, at(corner)) < 0.0;
    }
  }
  return false;
}

void HullMesh::makeSimplex(const std::array<std::uint32_t, 4>& corners) {
  auto [a, b, c, d] = corners;
  const double volume = exactVolume(at(a), at(b), at(c), at(d));
  if (volume == 0.0) {
    return;
  }
  if (volume > 0.0) {
    std::swap(b, c);
  }
  addFacet({a, b, c});
  addFacet({a, c, d});
  addFacet({a, d, b});
  addFacet({b, d, c});
  facets_[0].across = {2, 3, 1};
  facets_[1].across = {0, 3, 2};
  facets_[2].across = {1, 3, 0};
  facets_[3].across = {2, 1, 0};
}

std::uint32_t HullMesh::addFacet(const std::array<std::uint32_t, 3>& corner) {
  Facet facet;
  facet.corner = corner;
  facet.normal = normalOf(at(corner[0]), at(corner[1]), at(corner[2]));
  facets_.push_back(std::move(facet));
  return static_cast<std::uint32_t>(facets_.size() - 1);
}

// Adds the point to the facet, from first_facet on, above which it is highest.
void HullMesh::assign(std::uint32_t point, std::uint32_t first_facet) {
  double best = tolerance_;
  std::size_t best_facet = facets_.size();
  for (std::size_t f = first_facet; f < facets_.size(); ++f) {
    const double height = dot(facets_[f].normal, at(point) - at(facets_[f].corner[0]));
    if (height > best) {
      best = height;
      best_facet = f;
    }
  }
  if (best_facet < facets_.size()) {
    facets_[best_facet].outside.push_back(point);
  }
}

// Where points have about the same height, the one farthest from the middle is taken: it is a corner, not a
// point of an edge.
std::uint32_t HullMesh::farthestOutside(const Facet& facet) const {
  const Vec3d first = at(facet.corner[0]);
  double max_height = 0.0;
  for (const std::uint32_t i : facet.outside) {
    max_height = std::max(max_height, dot(facet.normal, at(i) - first));
  }
  std::uint32_t best = facet.outside[0];
  double best_distance = -1.0;
  for (const std::uint32_t i : facet.outside) {
    const double distance = length(at(i) - middle_);
    if (distance > best_distance && dot(facet.normal, at(i) - first) >= max_height - tolerance_) {
      best = i;
      best_distance = distance;
    }
  }
  return best;
}

void HullMesh::findVisible(std::uint32_t point, std::uint32_t facet) {
  visible_.assign(1, facet);
  facets_[facet].visible = true;
  for (std::size_t next = 0; next < visible_.size(); ++next) {
    for (const std::uint32_t neighbour : facets_[visible_[next]].across) {
      if (!facets_[neighbour].visible && above(facets_[neighbour], at(point)) > 0.0) {
        facets_[neighbour].visible = true;
        visible_.push_back(neighbour);
      }
    }
  }
}

// Adds a facet from the point to each border edge of the visible facets.
void HullMesh::addCone(std::uint32_t point) {
  const auto first_new = static_cast<std::uint32_t>(facets_.size());
  for (const std::uint32_t seen : visible_) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t beyond = facets_[seen].across[i];
      if (facets_[beyond].visible) {
        continue;
      }
      const std::uint32_t a = facets_[seen].corner[i];
      const std::uint32_t b = facets_[seen].corner[(i + 1) % 3];
      const std::uint32_t made = addFacet({a, b, point});
      facets_[made].across[0] = beyond;
      facet_of_[a] = made;
      for (std::size_t j = 0; j < 3; ++j) {
        if (facets_[beyond].corner[j] == b && facets_[beyond].corner[(j + 1) % 3] == a) {
          facets_[beyond].across[j] = made;
        }
      }
    }
  }
  for (std::uint32_t made = first_new; made < facets_.size(); ++made) {
    const std::uint32_t next = facet_of_[facets_[made].corner[1]];
    facets_[made].across[1] = next;
    facets_[next].across[2] = made;
  }
}

void HullMesh::insert(std::uint32_t point, std::uint32_t facet) {
  if (!(above(facets_[facet], at(point)) > 0.0)) {
    return;
  }
  findVisible(point, facet);
  const auto first_new = static_cast<std::uint32_t>(facets_.size());
  addCone(point);
  for (const std::uint32_t seen : visible_) {
    const std::vector<std::uint32_t> outside = std::move(facets_[seen].outside);
    facets_[seen].outside.clear();
    facets_[seen].live = false;
    facets_[seen].visible = false;
    for (const std::uint32_t other : outside) {
      if (other != point) {
        assign(other, first_new);
      }
    }
  }
}

}  // namespace sightline::layers
