// Coplanar, connected patches of an object's triangles.

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>

#include "src/occluders/polygon_merge.h"

namespace sightline::occluders {
namespace {

using Triangle = std::array<std::uint32_t, 3>;
constexpr std::uint32_t kNone = 0xffffffffu;

struct MeshEdge {
  std::uint32_t low, high;  // vertex ids
  std::uint32_t corner;     // 3 * triangle + number of the edge
  bool forward;             // runs from low to high in its triangle

  friend bool sameLine(const MeshEdge& a, const MeshEdge& b) { return a.low == b.low && a.high == b.high; }
};

Vec3d at(std::span<const Vec3f> positions, std::uint32_t id) {
  return Vec3d(positions[id]);
}

Vec3d doubleAreaNormal(std::span<const Vec3f> positions, const Triangle& t) {
  const Vec3d a = at(positions, t[0]);
  return cross(at(positions, t[1]) - a, at(positions, t[2]) - a);
}

// Without those that have no area beyond rounding, and without doubles.
std::vector<Triangle> usableTriangles(std::span<const Vec3f> positions,
                                      std::span<const std::uint32_t> indices, bool double_sided,
                                      double tolerance) {
  std::vector<std::pair<Triangle, Triangle>> keyed;  // identity, triangle
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    const Triangle t{indices[i], indices[i + 1], indices[i + 2]};
    double longest = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      longest = std::max(longest, length(at(positions, t[k]) - at(positions, t[(k + 1) % 3])));
    }
    if (!(length(doubleAreaNormal(positions, t)) > 4.0 * tolerance * longest)) {
      continue;
    }
    Triangle key = t;
    if (double_sided) {
      std::sort(key.begin(), key.end());
    } else {
      std::rotate(key.begin(), std::min_element(key.begin(), key.end()), key.end());
    }
    keyed.emplace_back(key, t);
  }
  std::stable_sort(keyed.begin(), keyed.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  keyed.erase(std::unique(keyed.begin(), keyed.end(),
                          [](const auto& a, const auto& b) { return a.first == b.first; }),
              keyed.end());
  std::vector<Triangle> triangles;
  triangles.reserve(keyed.size());
  for (const auto& [key, triangle] : keyed) {
    triangles.push_back(triangle);
  }
  return triangles;
}

// The one triangle beyond each edge, as 3 * triangle + edge; kNone where there is none, or more than one.
std::vector<std::uint32_t> findNeighbours(std::span<const Triangle> triangles, bool double_sided) {
  std::vector<MeshEdge> edges;
  edges.reserve(3 * triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles[t][k], b = triangles[t][(k + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), 3 * t + k, a < b});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const MeshEdge& a, const MeshEdge& b) {
    return std::tie(a.low, a.high, a.corner) < std::tie(b.low, b.high, b.corner);
  });
  std::vector<std::uint32_t> neighbour(edges.size(), kNone);
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i + 1;
    while (end < edges.size() && sameLine(edges[i], edges[end])) {
      ++end;
    }
    if (end - i == 2 && (double_sided || edges[i].forward != edges[i + 1].forward)) {
      neighbour[edges[i].corner] = edges[i + 1].corner;
      neighbour[edges[i + 1].corner] = edges[i].corner;
    }
    i = end;
  }
  return neighbour;
}

// Grows one patch from a seed over neighbours that lie in its plane; turns triangles of double-sided surfaces
// to the seed's winding.
class PatchGrower {
 public:
  PatchGrower(std::span<const Vec3f> positions, std::vector<Triangle>& triangles,
              std::span<const std::uint32_t> neighbour, double tolerance)
      : positions_(positions), triangles_(triangles), neighbour_(neighbour), tolerance_(tolerance) {
    taken_.resize(triangles.size(), false);
    flipped_.resize(triangles.size(), false);
  }

  bool taken(std::uint32_t triangle) const { return taken_[triangle]; }

  Patch grow(std::uint32_t seed) {
    Patch patch;
    const Vec3d normal = normalized(doubleAreaNormal(positions_, triangles_[seed]));
    patch.plane = {normal, -dot(normal, at(positions_, triangles_[seed][0]))};
    std::vector<std::uint32_t> queue{seed};
    taken_[seed] = true;
    flipped_[seed] = false;
    while (!queue.empty()) {
      const std::uint32_t t = queue.back();
      queue.pop_back();
      append(patch, t);
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t corner = neighbour_[3 * t + k];
        if (corner != kNone && !taken_[corner / 3] && joins(patch.plane, t, k, corner)) {
          taken_[corner / 3] = true;
          queue.push_back(corner / 3);
        }
      }
    }
    return patch;
  }

 private:
  void append(Patch& patch, std::uint32_t t) const {
    Triangle triangle = triangles_[t];
    if (flipped_[t]) {
      std::swap(triangle[1], triangle[2]);
    }
    for (const std::uint32_t id : triangle) {
      patch.deviation = std::max(patch.deviation, std::abs(patch.plane.evaluate(at(positions_, id))));
    }
    patch.triangles.push_back(triangle);
  }

  bool joins(const Plane& plane, std::uint32_t from, std::uint32_t edge, std::uint32_t corner) {
    const Triangle& other = triangles_[corner / 3];
    for (const std::uint32_t id : other) {
      if (std::abs(plane.evaluate(at(positions_, id))) > tolerance_) {
        return false;
      }
    }
    const bool same_direction = triangles_[from][edge] == other[corner % 3];
    const bool flip = flipped_[from] != same_direction;
    const Vec3d normal = doubleAreaNormal(positions_, other) * (flip ? -1.0 : 1.0);
    flipped_[corner / 3] = flip;
    return dot(normal, plane.normal) > 0.99 * length(normal);
  }

  std::span<const Vec3f> positions_;
  std::vector<Triangle>& triangles_;
  std::span<const std::uint32_t> neighbour_;
  double tolerance_;
  std::vector<bool> taken_, flipped_;
};

}  // namespace

double roundingTolerance(double largest_coordinate) {
  return 0x1p-20 * largest_coordinate;
}

PatchResult findPatches(std::span<const Vec3f> positions, std::span<const std::uint32_t> indices,
                        bool double_sided, double tolerance) {
  std::vector<Triangle> triangles = usableTriangles(positions, indices, double_sided, tolerance);
  const std::vector<std::uint32_t> neighbour = findNeighbours(triangles, double_sided);

  // Seeds from the largest triangle down: its plane is the best known.
  std::vector<double> size(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    size[t] = length(doubleAreaNormal(positions, triangles[t]));
  }
  std::vector<std::uint32_t> order(triangles.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return size[a] > size[b]; });

  PatchResult result;
  result.degenerate = indices.size() / 3 - triangles.size();
  PatchGrower grower(positions, triangles, neighbour, tolerance);
  for (const std::uint32_t seed : order) {
    if (!grower.taken(seed)) {
      result.patches.push_back(grower.grow(seed));
    }
  }
  return result;
}

}  // namespace sightline::occluders
