// Based on: Sutherland, Hodgman. Reentrant polygon clipping. CACM 1974.

#include "sightline/layers/pre_split.h"

#include <algorithm>
#include <cstddef>

namespace sightline {
namespace {

struct Corner {
  Vec3d position, weights;
};

struct Bounds {
  Vec3d min{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
            std::numeric_limits<double>::infinity()};
  Vec3d max = -min;

  void extend(const Vec3d& p) {
    min = sightline::min(min, p);
    max = sightline::max(max, p);
  }
  bool intersects(const Bounds& b, double slack) const {
    for (int axis = 0; axis < 3; ++axis) {
      if (min[axis] > b.max[axis] + slack || b.min[axis] > max[axis] + slack) {
        return false;
      }
    }
    return true;
  }
};

// Whether a cell owns the triangles in its plane. The neighbour's plane has the opposite normal, so exactly
// one of the two cells does.
bool ownsItsPlane(const Vec3d& normal) {
  return normal.x > 0.0 || (normal.x == 0.0 && (normal.y > 0.0 || (normal.y == 0.0 && normal.z > 0.0)));
}

// The point where an edge crosses the plane. Computed from the end in front, so that triangles that share an
// edge get the same point.
Corner crossing(const Corner& front, const Corner& behind, double front_distance, double behind_distance) {
  const double t = front_distance / (front_distance - behind_distance);
  return {front.position + (behind.position - front.position) * t,
          front.weights + (behind.weights - front.weights) * t};
}

class Clipper {
 public:
  // Returns the part of the triangle in front of all planes: empty, or at least three corners.
  std::span<const Corner> clip(const std::array<Vec3d, 3>& triangle, std::span<const Plane> planes) {
    polygon_.assign({{triangle[0], {1, 0, 0}}, {triangle[1], {0, 1, 0}}, {triangle[2], {0, 0, 1}}});
    for (const Plane& plane : planes) {
      if (!keepFront(plane)) {
        return {};
      }
    }
    return polygon_;
  }

 private:
  bool keepFront(const Plane& plane) {
    distances_.clear();
    bool any_behind = false, any_in_front = false;
    for (const Corner& corner : polygon_) {
      distances_.push_back(plane.evaluate(corner.position));
      any_behind = any_behind || distances_.back() < 0.0;
      any_in_front = any_in_front || distances_.back() > 0.0;
    }
    if (!any_behind) {
      return any_in_front || ownsItsPlane(plane.normal);
    }
    if (!any_in_front) {
      return false;
    }
    scratch_.clear();
    for (std::size_t i = 0; i < polygon_.size(); ++i) {
      const std::size_t next = i + 1 < polygon_.size() ? i + 1 : 0;
      const double here = distances_[i], there = distances_[next];
      if (here >= 0.0) {
        scratch_.push_back(polygon_[i]);
      }
      if (here > 0.0 && there < 0.0) {
        scratch_.push_back(crossing(polygon_[i], polygon_[next], here, there));
      } else if (here < 0.0 && there > 0.0) {
        scratch_.push_back(crossing(polygon_[next], polygon_[i], there, here));
      }
    }
    polygon_.swap(scratch_);
    return polygon_.size() >= 3;
  }

  std::vector<Corner> polygon_, scratch_;
  std::vector<double> distances_;
};

void appendFan(SplitPiece& piece, std::span<const Corner> polygon, std::uint32_t source) {
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    const Corner &a = polygon[0], &b = polygon[i - 1], &c = polygon[i];
    piece.triangles.push_back(
        {{a.position, b.position, c.position}, {a.weights, b.weights, c.weights}, source});
  }
}

Bounds boundsOf(const SplitPiece& piece) {
  Bounds bounds;
  for (const SplitTriangle& triangle : piece.triangles) {
    for (const Vec3d& position : triangle.positions) {
      bounds.extend(position);
    }
  }
  return bounds;
}

std::vector<SplitNeighbours> neighboursOf(const SplitMesh& mesh, const SplitCells& cells) {
  std::vector<Bounds> bounds;
  double size = 0.0;
  for (const SplitPiece& piece : mesh.pieces) {
    bounds.push_back(boundsOf(piece));
    size = std::max({size, maxComponent(abs(bounds.back().min)), maxComponent(abs(bounds.back().max))});
  }
  // Rounding of the clipping may separate boxes that touch by this much.
  const double slack = 1e-12 * size;
  std::vector<SplitNeighbours> neighbours;
  for (std::uint32_t i = 0; i < mesh.pieces.size(); ++i) {
    for (std::uint32_t k = i + 1; k < mesh.pieces.size(); ++k) {
      if (bounds[i].intersects(bounds[k], slack)) {
        neighbours.push_back({i, k, {planeBetween(cells, mesh.pieces[i].cell, mesh.pieces[k].cell)}});
      }
    }
  }
  return neighbours;
}

}  // namespace

SplitMesh splitMesh(std::span<const Vec3d> positions, std::span<const std::array<std::uint32_t, 3>> triangles,
                    const SplitCells& cells, double inflation) {
  SplitMesh mesh;
  Clipper clipper;
  for (std::uint32_t cell = 0; cell < cells.count; ++cell) {
    const std::vector<Plane> planes = cellPlanes(cells, cell, inflation);
    SplitPiece piece;
    piece.cell = cell;
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      const auto& [a, b, c] = triangles[t];
      appendFan(piece, clipper.clip({positions[a], positions[b], positions[c]}, planes), t);
    }
    if (!piece.triangles.empty()) {
      mesh.pieces.push_back(std::move(piece));
    }
  }
  mesh.neighbours = neighboursOf(mesh, cells);
  return mesh;
}

}  // namespace sightline
