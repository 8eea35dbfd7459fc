// Convex polygons out of a patch of coplanar triangles: neighbours are merged while the result stays convex,
// the most compact result first.
//
// Based on: Hertel, Mehlhorn. Fast triangulation of simple polygons. FCT 1983 (removing diagonals while
// convex). Differs in: the order, largest first and compact first; several edges of a common boundary go in
// one step.

#include "src/occluders/polygon_merge.h"

#include <algorithm>
#include <bit>
#include <numeric>

namespace sightline::occluders {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;
// Beyond so many vertices, a polygon grows no further before the others have had their turn. Each merge takes
// time in proportion to its boundary, and a long strip would grow by a triangle at a time. A row of a wall
// that stops halfway ends in a slant, so walls with a longer boundary may come out in several polygons.
constexpr std::size_t kLongLoop = 2048;

std::uint64_t directedEdge(std::uint32_t from, std::uint32_t to) {
  return (static_cast<std::uint64_t>(from) << 32) | to;
}

// To which polygon each directed edge belongs, in one block of memory: there are patches of two triangles by
// the million.
class EdgeOwners {
 public:
  explicit EdgeOwners(std::size_t most_edges) : slots_(std::bit_ceil(2 * most_edges + 1)) {}

  // kNone: to none.
  std::uint32_t of(std::uint64_t edge) const { return slots_[slotOf(edge)].owner; }
  void set(std::uint64_t edge, std::uint32_t owner) { slots_[slotOf(edge)] = {edge, owner}; }

 private:
  struct Slot {
    std::uint64_t edge = 0;
    std::uint32_t owner = kNone;
  };

  // The slot with the edge, or the free one that it would get.
  std::size_t slotOf(std::uint64_t edge) const {
    std::size_t slot = static_cast<std::size_t>((edge * 0x9e3779b97f4a7c15u) >> 32);
    while (slots_[slot &= slots_.size() - 1].owner != kNone && slots_[slot].edge != edge) {
      ++slot;
    }
    return slot;
  }

  std::vector<Slot> slots_;  // a power of two, at least half of them free
};

class Merger {
 public:
  Merger(std::span<const Vec3f> positions, const Patch& patch, double tolerance, std::uint32_t max_vertices)
      : positions_(positions),
        tolerance_(tolerance),
        max_vertices_(max_vertices),
        owners_(3 * patch.triangles.size()) {
    for (const auto& triangle : patch.triangles) {
      FoundPolygon polygon;
      polygon.loop.assign(triangle.begin(), triangle.end());
      polygon.plane = patch.plane;
      polygon.slack = patch.deviation;
      polygon.triangle_count = 1;
      if (!edgesAreFree(polygon.loop) || !finishPolygon(positions_, tolerance_, max_vertices_, polygon)) {
        continue;  // overlaps another one, or has no inside
      }
      claimEdges(polygon.loop, static_cast<std::uint32_t>(polygons_.size()));
      polygons_.push_back(std::move(polygon));
    }
  }

  std::vector<FoundPolygon> run() {
    bool merged = polygons_.size() > 1;
    while (merged) {
      merged = false;
      for (const std::uint32_t p : byArea()) {
        const std::size_t most = std::max(2 * polygons_[p].loop.size(), kLongLoop);
        while (!polygons_[p].loop.empty() && polygons_[p].loop.size() <= most && mergeBest(p)) {
          merged = true;
        }
      }
    }
    std::erase_if(polygons_, [](const FoundPolygon& p) { return p.loop.empty(); });
    return std::move(polygons_);
  }

 private:
  std::vector<std::uint32_t> byArea() const {
    std::vector<std::uint32_t> order;
    for (std::uint32_t p = 0; p < polygons_.size(); ++p) {
      if (!polygons_[p].loop.empty()) {
        order.push_back(p);
      }
    }
    std::stable_sort(order.begin(), order.end(), [this](std::uint32_t a, std::uint32_t b) {
      return polygons_[a].area > polygons_[b].area;
    });
    return order;
  }

  bool edgesAreFree(std::span<const std::uint32_t> loop) const {
    for (std::size_t i = 0; i < loop.size(); ++i) {
      if (owners_.of(directedEdge(loop[i], loop[(i + 1) % loop.size()])) != kNone) {
        return false;
      }
    }
    return true;
  }

  void claimEdges(std::span<const std::uint32_t> loop, std::uint32_t p) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
      owners_.set(directedEdge(loop[i], loop[(i + 1) % loop.size()]), p);
    }
  }

  // The polygon beyond edge i of p.
  std::uint32_t beyond(std::uint32_t p, std::size_t i) const {
    const std::vector<std::uint32_t>& loop = polygons_[p].loop;
    const std::uint32_t owner = owners_.of(directedEdge(loop[(i + 1) % loop.size()], loop[i]));
    return owner == p ? kNone : owner;
  }

  double compactness(const FoundPolygon& polygon) const {
    double perimeter = 0.0;
    for (std::size_t i = 0; i < polygon.corners.size(); ++i) {
      const std::uint32_t a = polygon.loop[polygon.corners[i]];
      const std::uint32_t b = polygon.loop[polygon.corners[(i + 1) % polygon.corners.size()]];
      perimeter += length(Vec3d(positions_[a]) - Vec3d(positions_[b]));
    }
    return polygon.area / (perimeter * perimeter);
  }

  // Whether the boundary p -> q -> r turns away from the inside by clearly more than the tolerance.
  bool turnsRight(std::uint32_t p, std::uint32_t q, std::uint32_t r, const Vec3d& normal) const {
    const Vec3d from(positions_[p]), at(positions_[q]), to(positions_[r]);
    return dot(cross(at - from, to - at), normal) < -4.0 * tolerance_ * length(to - from);
  }

  // The union of p and q, which share edge i of p; an empty loop when their common boundary is not one chain.
  FoundPolygon joined(std::uint32_t p, std::uint32_t q, std::size_t i) const {
    const FoundPolygon& a = polygons_[p];
    const FoundPolygon& b = polygons_[q];
    const std::size_t n = a.loop.size(), m = b.loop.size();
    std::size_t first = i;  // the chain of common edges in a: [first, last]
    std::size_t count = 1;
    while (count < n && beyond(p, (first + n - 1) % n) == q) {
      first = (first + n - 1) % n;
      ++count;
    }
    while (count < n && beyond(p, (first + count) % n) == q) {
      ++count;
    }
    FoundPolygon result;
    const std::uint32_t chain_start = a.loop[first], chain_end = a.loop[(first + count) % n];
    const auto positionIn = [](const FoundPolygon& polygon, std::uint32_t vertex) {
      const auto found = std::find(polygon.loop.begin(), polygon.loop.end(), vertex);
      return static_cast<std::size_t>(found - polygon.loop.begin());
    };
    const std::size_t start_b = positionIn(b, chain_start), end_b = positionIn(b, chain_end);
    // Most candidates turn the wrong way where the two boundaries meet: known before anything is built.
    if (start_b == m || end_b == m ||
        turnsRight(a.loop[(first + n - 1) % n], chain_start, b.loop[(start_b + 1) % m], a.plane.normal) ||
        turnsRight(b.loop[(end_b + m - 1) % m], chain_end, a.loop[(first + count + 1) % n], a.plane.normal)) {
      return result;
    }
    const std::uint32_t shorter = n < m ? p : q, longer = n < m ? q : p;
    std::size_t common = 0;
    for (std::size_t k = 0; k < std::min(n, m); ++k) {
      common += beyond(shorter, k) == longer ? 1 : 0;
    }
    if (common != count || count >= n || count >= m) {
      return result;
    }
    for (std::size_t k = 0; k < n - count; ++k) {
      result.loop.push_back(a.loop[(first + count + k) % n]);
    }
    // a's part ends just before chain_start; b's part runs from chain_start to the chain's end.
    for (std::size_t k = 0; k < m - count; ++k) {
      result.loop.push_back(b.loop[(start_b + k) % m]);
    }
    result.plane = a.plane;
    result.slack = std::max(a.slack, b.slack);
    result.triangle_count = a.triangle_count + b.triangle_count;
    return result;
  }

  bool mergeBest(std::uint32_t p) {
    FoundPolygon best;
    std::uint32_t best_partner = kNone;
    double best_score = 0.0;
    std::uint32_t previous = kNone;
    for (std::size_t i = 0; i < polygons_[p].loop.size(); ++i) {
      const std::uint32_t q = beyond(p, i);
      if (q == kNone || q == previous) {
        continue;
      }
      previous = q;
      FoundPolygon candidate = joined(p, q, i);
      if (candidate.loop.empty() || !finishPolygon(positions_, tolerance_, max_vertices_, candidate)) {
        continue;
      }
      const double score = compactness(candidate);
      if (best_partner == kNone || score > best_score) {
        best = std::move(candidate);
        best_partner = q;
        best_score = score;
      }
    }
    if (best_partner == kNone) {
      return false;
    }
    claimEdges(polygons_[best_partner].loop, p);
    polygons_[best_partner].loop.clear();
    polygons_[p] = std::move(best);
    return true;
  }

  std::span<const Vec3f> positions_;
  double tolerance_;
  std::uint32_t max_vertices_;
  std::vector<FoundPolygon> polygons_;
  EdgeOwners owners_;  // stale ones are inside polygons
};

struct Point2 {
  double x, y;
};

double distanceToLine(const Point2& p, const Point2& a, const Point2& b) {
  const double dx = b.x - a.x, dy = b.y - a.y;
  const double l = std::sqrt(dx * dx + dy * dy);
  return l > 0.0 ? (dx * (p.y - a.y) - dy * (p.x - a.x)) / l : 0.0;
}

// Corners: where leaving the vertex out would move the boundary by more than the tolerance. -1: not convex.
int markCorners(std::span<const Point2> points, double tolerance, std::vector<std::uint32_t>& corners) {
  const std::size_t n = points.size();
  corners.clear();
  // Start at an extreme vertex, which is a corner for sure.
  std::size_t start = 0;
  for (std::size_t i = 1; i < n; ++i) {
    if (points[i].x < points[start].x || (points[i].x == points[start].x && points[i].y < points[start].y)) {
      start = i;
    }
  }
  corners.push_back(static_cast<std::uint32_t>(start));
  for (std::size_t k = 1; k < n; ++k) {
    const std::size_t i = (start + k) % n;
    const Point2& next = points[(i + 1) % n];
    const double turn = -distanceToLine(points[i], points[corners.back()], next);
    if (turn < -tolerance) {
      return -1;
    }
    if (turn > tolerance) {
      corners.push_back(static_cast<std::uint32_t>(i));
    }
  }
  return static_cast<int>(corners.size());
}

// Convex, and all of the boundary within the tolerance of the polygon through the corners.
bool cornersDescribe(std::span<const Point2> points, std::span<const std::uint32_t> corners, double tolerance,
                     double& slack) {
  const std::size_t n = points.size(), c = corners.size();
  double turned = 0.0;
  for (std::size_t i = 0; i < c; ++i) {
    const Point2& a = points[corners[i]];
    const Point2& b = points[corners[(i + 1) % c]];
    const Point2& d = points[corners[(i + 2) % c]];
    const double ux = b.x - a.x, uy = b.y - a.y, vx = d.x - b.x, vy = d.y - b.y;
    const double angle = std::atan2(ux * vy - uy * vx, ux * vx + uy * vy);
    if (!(angle > 0.0)) {
      return false;
    }
    turned += angle;
    for (std::size_t k = (corners[i] + 1) % n; k != corners[(i + 1) % c]; k = (k + 1) % n) {
      slack = std::max(slack, std::abs(distanceToLine(points[k], a, b)));
    }
  }
  constexpr double kFullTurn = 6.283185307179586;
  return std::abs(turned - kFullTurn) < 1e-3 && slack <= 2.0 * tolerance;
}

}  // namespace

bool finishPolygon(std::span<const Vec3f> positions, double tolerance, std::uint32_t max_vertices,
                   FoundPolygon& polygon) {
  const std::vector<std::uint32_t>& loop = polygon.loop;
  const Vec3d normal = polygon.plane.normal;
  const Vec3d origin(positions[loop[0]]);
  const Vec3d u = normalized(cross(std::abs(normal.x) < 0.7 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0), normal));
  const Vec3d v = cross(normal, u);
  std::vector<Point2> points;
  points.reserve(loop.size());
  for (const std::uint32_t id : loop) {
    const Vec3d p = Vec3d(positions[id]) - origin;
    points.push_back({dot(p, u), dot(p, v)});
  }
  const int corner_count = markCorners(points, tolerance, polygon.corners);
  if (corner_count < 3 || corner_count > static_cast<int>(max_vertices)) {
    return false;
  }
  double boundary_slack = 0.0;
  if (!cornersDescribe(points, polygon.corners, tolerance, boundary_slack)) {
    return false;
  }
  // Area and centroid of the fan around the first vertex.
  double area = 0.0, x = 0.0, y = 0.0;
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    const Point2 &a = points[i], &b = points[i + 1];
    const double part = 0.5 * (a.x * b.y - a.y * b.x);
    area += part;
    x += part * (a.x + b.x) / 3.0;
    y += part * (a.y + b.y) / 3.0;
  }
  if (!(area > 0.0)) {
    return false;
  }
  polygon.area = area;
  polygon.centroid = origin + u * (x / area) + v * (y / area);
  polygon.slack = std::max(polygon.slack, boundary_slack);
  return true;
}

std::vector<FoundPolygon> mergePatch(std::span<const Vec3f> positions, const Patch& patch, double tolerance,
                                     std::uint32_t max_vertices) {
  return Merger(positions, patch, tolerance, max_vertices).run();
}

}  // namespace sightline::occluders
