#include "src/pvs/bake/cell_region.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "src/geometry/clip_convex.h"

namespace sightline::pvs {
namespace {

// Two corners that differ in one coordinate.
struct BoxEdge {
  std::uint32_t from, to;
  int axis;
};
constexpr std::array<BoxEdge, 12> kBoxEdges{{{0, 1, 0},
                                             {2, 3, 0},
                                             {4, 5, 0},
                                             {6, 7, 0},
                                             {0, 2, 1},
                                             {1, 3, 1},
                                             {4, 6, 1},
                                             {5, 7, 1},
                                             {0, 4, 2},
                                             {1, 5, 2},
                                             {2, 6, 2},
                                             {3, 7, 2}}};

// Minimum fraction of a plane's cross-section that faces must cover for the plane to divide a cell.
constexpr double kMinCoverage = 0.5;
constexpr std::size_t kMaxTried = 16;  // maximum number of faces whose planes are tried

// The point where the plane dot(normal, x) = level crosses the edge, clamped to the edge. The edge's ends
// must lie on different sides.
Vec3d crossing(const CellBox& cell, const BoxEdge& edge, const Vec3d& normal, double level) {
  Vec3d point = cell.corner(edge.from);
  const Vec3d end = cell.corner(edge.to);
  const double from = dot(normal, point) - level, to = dot(normal, end) - level;
  const double low = point[edge.axis], high = end[edge.axis];
  point[edge.axis] = std::clamp(low + (high - low) * (from / (from - to)), low, high);
  return point;
}

// Corners of the plane's cross-section with the cell, unordered. Empty if the plane does not intersect the
// cell.
std::vector<Vec3d> crossSection(const CellBox& cell, const Vec3d& normal, double level) {
  std::vector<Vec3d> points;
  for (const BoxEdge& edge : kBoxEdges) {
    const double from = dot(normal, cell.corner(edge.from)) - level;
    const double to = dot(normal, cell.corner(edge.to)) - level;
    if ((from < 0.0 && to > 0.0) || (from > 0.0 && to < 0.0)) {
      points.push_back(crossing(cell, edge, normal, level));
    }
  }
  return points;
}

struct Corner {
  Vec3d position;
};

double areaOf(std::span<const Corner> polygon) {
  Vec3d twice;
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    twice += cross(polygon[i - 1].position - polygon[0].position, polygon[i].position - polygon[0].position);
  }
  return 0.5 * length(twice);
}

// Clips the polygon to the cell.
void clipTo(const CellBox& cell, std::vector<Corner>& polygon) {
  std::vector<Corner> scratch;
  for (int axis = 0; axis < 3; ++axis) {
    geometry::clipConvex(polygon, scratch, Corner{},
                         [&](const Vec3d& p) { return p[axis] - cell.min[axis]; }) &&
        geometry::clipConvex(polygon, scratch, Corner{},
                             [&](const Vec3d& p) { return cell.max[axis] - p[axis]; });
  }
}

// Area of the plane's cross-section with the cell, computed by clipping a square that is larger than the
// cell.
double sectionArea(const CellBox& cell, const Vec3d& normal, double level) {
  const Vec3d centre = cell.centre() + normal * (level - dot(normal, cell.centre()));
  const int axis = std::abs(normal.x) < 0.5 ? 0 : 1;
  Vec3d other;
  other[axis] = 1.0;
  const double reach = length(cell.extent());
  const Vec3d u = normalized(cross(normal, other)) * reach, v = cross(normal, u);
  std::vector<Corner> square{{centre + u + v}, {centre - u + v}, {centre - u - v}, {centre + u - v}};
  clipTo(cell, square);
  return areaOf(square);
}

// Distance of the face's plane from the origin along its normal, metres.
double levelOf(const DividingFace& face) {
  return -face.plane.offset;
}

// A face that lies in the cell or just outside.
struct FaceInCell {
  const DividingFace* face = nullptr;
  double area = 0.0;     // area of the face in the cell
  double section = 0.0;  // area of its plane's cross-section with the cell
};

// Distances in metres from a face's plane within which viewers count as between its sides.
struct Clearance {
  double near_distance, side_margin;

  double of(const DividingFace& face) const {
    return near_distance * (1.0 + 0x1p-20) + 4.0 * face.margin + 4.0 * side_margin;
  }
};

// Measures a face. If its plane passes just outside the cell, the face is measured where viewers begin to be
// in front of it.
FaceInCell measured(const CellBox& cell, const DividingFace& face, const Clearance& clearance) {
  const Vec3d& normal = face.plane.normal;
  FaceInCell found{&face, 0.0, 0.0};
  for (const double moved : {0.0, clearance.of(face)}) {
    found.section = sectionArea(cell, normal, levelOf(face) + moved);
    if (found.section > 0.0) {
      std::vector<Corner> polygon;
      for (const ConvexEdge& edge : face.edges) {
        polygon.push_back({edge.from + normal * moved});
      }
      clipTo(cell, polygon);
      found.area = areaOf(polygon);
      return found;
    }
  }
  return found;
}

bool inOnePlane(const DividingFace& a, const DividingFace& b) {
  return dot(a.plane.normal, b.plane.normal) > 1.0 - 1e-9 &&
         std::abs(levelOf(a) - levelOf(b)) <= 4.0 * (a.margin + b.margin);
}

// The fraction of the plane's cross-section with the cell that is covered by all faces in the face's plane.
double coverage(const FaceInCell& face, std::span<const FaceInCell> faces) {
  double area = 0.0;
  for (const FaceInCell& other : faces) {
    area += inOnePlane(*face.face, *other.face) ? other.area : 0.0;
  }
  return area / face.section;
}

// The level, in metres along the front's normal from the origin, of the back of the solid behind the face:
// that of the next face behind it that faces the other way. Its own level if there is none.
double backLevel(const DividingFace& front, std::span<const DividingFace* const> covering) {
  double back_level = levelOf(front);
  bool looks_back = front.double_sided;
  for (const DividingFace* face : covering) {
    const double level = -levelOf(*face);
    if (dot(face->plane.normal, front.plane.normal) < -1.0 + 1e-9 && level <= levelOf(front) &&
        (!looks_back || level > back_level)) {
      back_level = level;
      looks_back = true;
    }
  }
  return back_level;
}

}  // namespace

double CellBox::smallestFace() const {
  const Vec3d e = extent();
  return std::min({e.x * e.y, e.y * e.z, e.z * e.x});
}

std::vector<Vec3d> cornersOf(const CellBox& cell) {
  std::vector<Vec3d> corners;
  // Opposite corners come first, because an occluder hides little from both.
  for (const std::uint32_t i : {0, 7, 3, 4, 5, 2, 1, 6}) {
    corners.push_back(cell.corner(i));
  }
  return corners;
}

CellBox boundsOf(std::span<const Vec3d> points) {
  CellBox box{points[0], points[0]};
  for (const Vec3d& point : points) {
    box.min = min(box.min, point);
    box.max = max(box.max, point);
  }
  return box;
}

std::vector<Vec3d> cornersBefore(const CellBox& cell, const Vec3d& normal, double level) {
  std::vector<Vec3d> corners;
  for (std::uint32_t i = 0; i < 8; ++i) {
    if (dot(normal, cell.corner(i)) >= level) {
      corners.push_back(cell.corner(i));
    }
  }
  if (!corners.empty() && corners.size() < 8) {
    const std::vector<Vec3d> cut = crossSection(cell, normal, level);
    corners.insert(corners.end(), cut.begin(), cut.end());
  }
  return corners;
}

double sideMargin(const CellBox& cell) {
  const Vec3d reach = max(abs(cell.min), abs(cell.max));
  return 0x1p-40 * (reach.x + reach.y + reach.z);
}

std::optional<CellPlane> dividingPlane(const CellBox& cell, std::span<const DividingFace> faces,
                                       double near_distance, double side_margin) {
  const Clearance clearance{near_distance, side_margin};
  std::vector<FaceInCell> inside;
  for (const DividingFace& face : faces) {
    const FaceInCell found = measured(cell, face, clearance);
    if (found.area > 0.0) {
      inside.push_back(found);
    }
  }
  // Planes that are filled to rounding count as equally filled; among those, take the one nearest to the
  // centre.
  const Vec3d centre = cell.centre();
  const FaceInCell* best = nullptr;
  std::pair<double, double> best_rank;
  std::vector<const DividingFace*> covering;
  // If faces cover half of a section, some of them are among the largest.
  const std::size_t tried = std::min(inside.size(), kMaxTried);
  std::partial_sort(inside.begin(), inside.begin() + static_cast<std::ptrdiff_t>(tried), inside.end(),
                    [](const FaceInCell& a, const FaceInCell& b) {
                      return a.area != b.area ? a.area > b.area : a.face < b.face;
                    });
  for (const FaceInCell& face : std::span(inside).first(tried)) {
    const double covered = coverage(face, inside);
    if (covered < kMinCoverage) {
      continue;
    }
    covering.push_back(face.face);
    const std::pair rank(-std::min(covered, 0.999), std::abs(face.face->plane.evaluate(centre)));
    if (best == nullptr || rank < best_rank) {
      best = &face;
      best_rank = rank;
    }
  }
  if (best == nullptr) {
    return std::nullopt;
  }
  const DividingFace& front = *best->face;
  const Vec3d& normal = front.plane.normal;
  const CellPlane plane{normal, levelOf(front) + clearance.of(front),
                        backLevel(front, covering) - clearance.of(front)};
  const bool some_before = !cornersBefore(cell, normal, plane.front).empty();
  const bool some_behind = !cornersBefore(cell, -normal, -plane.back).empty();
  return some_before || some_behind ? std::optional(plane) : std::nullopt;
}

}  // namespace sightline::pvs
