// Whether one mesh lies inside another, in exact arithmetic.
//
// If no triangle of the occluder meets one of the drawn mesh, each connected piece of it lies wholly inside
// or wholly outside. Which of the two, a segment from one of its points to a point far away tells, by how
// often it leaves the drawn mesh, less how often it enters it: the winding number of the point.

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "sightline/math/box.h"
#include "sightline/world/world_mesh.h"
#include "src/base/union_find.h"
#include "src/geometry/exact_point.h"
#include "src/math/point_text.h"
#include "src/world/read_mesh.h"

namespace sightline {

using namespace world;

namespace {

using geometry::Lattice;
using geometry::orientation;
using Triangle = std::array<Vec3d, 3>;

Triangle triangleAt(const WeldedMesh& mesh, std::size_t first) {
  return {Vec3d(mesh.positions[mesh.indices[first]]), Vec3d(mesh.positions[mesh.indices[first + 1]]),
          Vec3d(mesh.positions[mesh.indices[first + 2]])};
}

Box boundsOf(const Triangle& triangle) {
  Box box;
  for (const Vec3d& corner : triangle) {
    box.extend(Vec3f(corner));
  }
  return box;
}

// Sets `sides` to those of the plane of b on which the corners of a are; true if all are strictly on one.
bool aside(const Lattice& lattice, const Triangle& a, const Triangle& b, std::array<int, 3>& sides) {
  for (std::size_t i = 0; i < 3; ++i) {
    sides[i] = orientation(lattice, b[0], b[1], b[2], a[i]);
  }
  return sides[0] != 0 && sides[0] == sides[1] && sides[1] == sides[2];
}

// Whether the line through p and q, which is not in the triangle's plane, meets it: 1 or -1 if it does so
// inside, by the sense in which the corners run around it; 0 at its border; nothing if it does not.
std::optional<int> through(const Lattice& lattice, const Vec3d& p, const Vec3d& q, const Triangle& t) {
  const int a = orientation(lattice, p, q, t[0], t[1]), b = orientation(lattice, p, q, t[1], t[2]),
            c = orientation(lattice, p, q, t[2], t[0]);
  if ((a > 0 || b > 0 || c > 0) && (a < 0 || b < 0 || c < 0)) {
    return std::nullopt;
  }
  return a == b && b == c ? a : 0;
}

// Whether an edge of a meets b. sides: those of the plane of b on which the corners of a are.
bool edgeMeets(const Lattice& lattice, const Triangle& a, const Triangle& b,
               const std::array<int, 3>& sides) {
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    if (sides[i] == 0 && sides[j] == 0) {
      return true;  // in the plane; their boxes overlap, which is near enough
    }
    if (sides[i] * sides[j] <= 0 && through(lattice, a[i], a[j], b)) {
      return true;
    }
  }
  return false;
}

bool meet(const Lattice& lattice, const Triangle& a, const Triangle& b) {
  std::array<int, 3> a_sides, b_sides;
  if (aside(lattice, a, b, a_sides) || aside(lattice, b, a, b_sides)) {
    return false;
  }
  return edgeMeets(lattice, a, b, a_sides) || edgeMeets(lattice, b, a, b_sides);
}

// How often the segment leaves the drawn mesh, less how often it enters it. `point` is on no triangle of the
// mesh, and `far` is beyond all of them. Nothing if the segment passes through an edge or a vertex, or lies
// in the plane of a triangle.
std::optional<int> winding(const Lattice& lattice, const Vec3d& point, const Vec3d& far,
                           const WeldedMesh& mesh) {
  int winding = 0;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const Triangle t = triangleAt(mesh, i);
    const int from = orientation(lattice, t[0], t[1], t[2], point),
              to = orientation(lattice, t[0], t[1], t[2], far);
    if (from == 0 && to == 0) {
      if (geometry::longestAxis(lattice, {t[0], t[1], t[2]}) < 0) {
        continue;  // it has no area
      }
      return std::nullopt;
    }
    // The segment crosses the plane only if its ends are on different sides. If just one end is in the plane,
    // that end is all of the segment that is, and neither end is on the triangle.
    if (from * to >= 0) {
      continue;
    }
    const std::optional<int> at = through(lattice, point, far, t);
    if (at && *at == 0) {
      return std::nullopt;
    }
    winding += at ? to : 0;
  }
  return winding;
}

Result<WeldedMesh> weldedFrom(const MeshView& view, const char* name) {
  const Result<ReadMesh> read = readMesh(view);
  if (!read) {
    return Error{"the " + std::string(name) + " mesh: " + read.error().message};
  }
  WeldedMesh mesh = weldMesh(*read);
  for (const Vec3f& p : mesh.positions) {
    if (!isFinite(p) || !Lattice::allowed(Vec3d(p))) {
      return Error{"the " + std::string(name) +
                   " mesh has a coordinate that is not finite or is beyond 2^64"};
    }
  }
  return mesh;
}

// Points far from all of a box. Their coordinates are whole numbers, so that the lattice stays coarse.
std::vector<Vec3d> pointsBeyond(const Box& box) {
  const Vec3d size = abs(center(box)) + Vec3d(box.extent());
  const double far = std::ceil(4.0 * maxComponent(size)) + 64.0;
  std::vector<Vec3d> points;
  for (int i = 0; i < 24; ++i) {
    const double a = std::floor(far * (i * 37 % 101) / 101.0), b = std::floor(far * (i * 53 % 97) / 97.0);
    const double side = i % 2 == 0 ? far : -far;
    points.push_back(i % 3 == 0 ? Vec3d(side, a, b) : i % 3 == 1 ? Vec3d(a, side, b) : Vec3d(a, b, side));
  }
  return points;
}

}  // namespace

Status checkInside(const MeshView& occluder, const MeshView& drawn) {
  const Result<WeldedMesh> inner = weldedFrom(occluder, "occluder's"), outer = weldedFrom(drawn, "drawn");
  if (!inner || !outer) {
    return inner ? outer.error() : inner.error();
  }
  if (outer->open_edges > 0) {
    return Error{"the drawn mesh is not closed: " + std::to_string(outer->open_edges) +
                 " of its edges are open, so nothing lies inside; close it, or take a box inside that is "
                 "drawn too"};
  }
  std::vector<Vec3d> points;
  Box bounds;
  for (const Vec3f& p : outer->positions) {
    points.emplace_back(p);
    bounds.extend(p);
  }
  for (const Vec3f& p : inner->positions) {
    points.emplace_back(p);
  }
  const std::vector<Vec3d> beyond = pointsBeyond(bounds.empty() ? Box{{0, 0, 0}, {0, 0, 0}} : bounds);
  points.insert(points.end(), beyond.begin(), beyond.end());
  const Lattice lattice = Lattice::of(points);

  std::vector<Box> outer_boxes;
  for (std::size_t i = 0; i < outer->indices.size(); i += 3) {
    outer_boxes.push_back(boundsOf(triangleAt(*outer, i)));
  }
  base::UnionFind pieces(inner->positions.size());
  for (std::size_t i = 0; i < inner->indices.size(); i += 3) {
    const Triangle own = triangleAt(*inner, i);
    const Box box = boundsOf(own);
    for (std::size_t o = 0; o < outer_boxes.size(); ++o) {
      if (overlaps(box, outer_boxes[o]) && meet(lattice, own, triangleAt(*outer, 3 * o))) {
        return Error{"a triangle of the occluder at " + math::textOf(own[0]) +
                     " meets the drawn mesh; move it inwards"};
      }
    }
    pieces.unite(inner->indices[i], inner->indices[i + 1]);
    pieces.unite(inner->indices[i], inner->indices[i + 2]);
  }
  for (const std::uint32_t vertex : inner->indices) {
    if (pieces.root(vertex) != vertex) {
      continue;
    }
    const Vec3d point(inner->positions[vertex]);
    std::optional<int> around;
    for (std::size_t i = 0; i < beyond.size() && !around; ++i) {
      around = winding(lattice, point, beyond[i], *outer);
    }
    if (!around || *around < 1) {
      return Error{"the occluder at " + math::textOf(point) + " lies outside of the drawn mesh"};
    }
  }
  return Success{};
}

}  // namespace sightline
