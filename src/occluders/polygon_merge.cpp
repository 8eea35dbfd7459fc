// Convex polygons out of a patch of coplanar triangles: neighbours are merged while the result stays convex,
// the most compact result first.
//
// Based on: Hertel, Mehlhorn. Fast triangulation of simple polygons. FCT 1983 (removing diagonals while
// convex). Differs in: the order, largest first and compact first; several edges of a common boundary go in
// one step.

#include "src/occluders/polygon_merge.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

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

}  // namespace

std::span<const std::uint32_t> IdStore::copy(std::span<const std::uint32_t> loop,
                                             std::span<const std::uint32_t> corners) {
  constexpr std::size_t kBlock = 16384;
  const std::size_t size = loop.size() + corners.size();
  if (blocks_.empty() || blocks_.back().capacity() - blocks_.back().size() < size) {
    blocks_.emplace_back().reserve(std::max(kBlock, size));
  }
  std::vector<std::uint32_t>& block = blocks_.back();
  block.insert(block.end(), loop.begin(), loop.end());
  block.insert(block.end(), corners.begin(), corners.end());
  return std::span(block).last(size);
}

FoundPolygon foundPolygon(const GrowingPolygon& polygon, const Plane& plane, IdStore& ids) {
  FoundPolygon found;
  found.setOutline(ids.copy(polygon.loop, polygon.corners), polygon.corners.size());
  found.plane = plane;
  found.centroid = Vec3f(polygon.centroid);
  found.area = polygon.area;
  found.slack = static_cast<float>(polygon.slack * 1.001);
  found.triangle_count = polygon.triangle_count;
  return found;
}

void PolygonMerger::EdgeOwners::reset(std::size_t most_edges) {
  slots_.assign(std::bit_ceil(2 * most_edges + 1), {});
}

// The slot with the edge, or the free one that it would get.
std::size_t PolygonMerger::EdgeOwners::slotOf(std::uint64_t edge) const {
  std::size_t slot = static_cast<std::size_t>((edge * 0x9e3779b97f4a7c15u) >> 32);
  while (slots_[slot &= slots_.size() - 1].owner != kNone && slots_[slot].edge != edge) {
    ++slot;
  }
  return slot;
}

GrowingPolygon& PolygonMerger::addPolygon() {
  if (polygon_count_ == polygons_.size()) {
    polygons_.emplace_back();
  }
  return polygons_[polygon_count_++];
}

// Begins with the triangles. Those that overlap another one, or have no inside, are left out.
void PolygonMerger::start(const Patch& patch, std::span<const PatchTriangle> triangles) {
  finisher_.setPlane(patch.plane, tolerance_);
  normal_ = patch.plane.normal;
  polygon_count_ = 0;
  if (triangles.size() > 1) {
    owners_.reset(3 * triangles.size());
  }
  for (const PatchTriangle& triangle : triangles) {
    GrowingPolygon& polygon = addPolygon();
    polygon.loop.assign(triangle.begin(), triangle.end());
    polygon.slack = patch.deviation;
    polygon.triangle_count = 1;
    if ((triangles.size() > 1 && !edgesAreFree(polygon.loop)) || !finisher_.finish(polygon)) {
      --polygon_count_;
    } else if (triangles.size() > 1) {
      claimEdges(polygon.loop, polygon_count_ - 1);
    }
  }
  alive_ = polygon_count_;
}

void PolygonMerger::mergeAll() {
  bool merged = true;
  while (merged && alive_ > 1) {
    merged = false;
    orderByArea();
    for (const std::uint32_t p : order_) {
      const std::size_t most = std::max(2 * polygons_[p].loop.size(), kLongLoop);
      while (alive_ > 1 && !polygons_[p].loop.empty() && polygons_[p].loop.size() <= most && mergeBest(p)) {
        merged = true;
      }
    }
  }
}

void PolygonMerger::merge(const Patch& patch, std::span<const PatchTriangle> triangles, double tolerance,
                          std::vector<FoundPolygon>& found, IdStore& ids) {
  tolerance_ = tolerance;
  start(patch, triangles);
  mergeAll();
  for (const GrowingPolygon& polygon : std::span(polygons_).first(polygon_count_)) {
    if (!polygon.loop.empty()) {
      found.push_back(foundPolygon(polygon, patch.plane, ids));
    }
  }
}

void PolygonMerger::orderByArea() {
  order_.clear();
  for (std::uint32_t p = 0; p < polygon_count_; ++p) {
    if (!polygons_[p].loop.empty()) {
      order_.push_back(p);
    }
  }
  std::sort(order_.begin(), order_.end(), [this](std::uint32_t a, std::uint32_t b) {
    return polygons_[a].area != polygons_[b].area ? polygons_[a].area > polygons_[b].area : a < b;
  });
}

bool PolygonMerger::edgesAreFree(std::span<const std::uint32_t> loop) const {
  for (std::size_t i = 0; i < loop.size(); ++i) {
    if (owners_.of(directedEdge(loop[i], loop[i + 1 < loop.size() ? i + 1 : 0])) != kNone) {
      return false;
    }
  }
  return true;
}

void PolygonMerger::claimEdges(std::span<const std::uint32_t> loop, std::uint32_t p) {
  for (std::size_t i = 0; i < loop.size(); ++i) {
    owners_.set(directedEdge(loop[i], loop[i + 1 < loop.size() ? i + 1 : 0]), p);
  }
}

// The polygon beyond edge i of p.
std::uint32_t PolygonMerger::beyond(std::uint32_t p, std::size_t i) const {
  const std::vector<std::uint32_t>& loop = polygons_[p].loop;
  const std::uint32_t owner = owners_.of(directedEdge(loop[i + 1 < loop.size() ? i + 1 : 0], loop[i]));
  return owner == p ? kNone : owner;
}

double PolygonMerger::compactness(const GrowingPolygon& polygon) const {
  double perimeter = 0.0;
  for (std::size_t i = 0; i < polygon.corners.size(); ++i) {
    const std::size_t next = i + 1 < polygon.corners.size() ? i + 1 : 0;
    const std::uint32_t a = polygon.loop[polygon.corners[i]], b = polygon.loop[polygon.corners[next]];
    perimeter += length(Vec3d(positions_[a]) - Vec3d(positions_[b]));
  }
  return polygon.area / (perimeter * perimeter);
}

// Whether the boundary p -> q -> r turns away from the inside by clearly more than the tolerance.
bool PolygonMerger::turnsRight(std::uint32_t p, std::uint32_t q, std::uint32_t r) const {
  const Vec3d from(positions_[p]), at(positions_[q]), to(positions_[r]);
  return dot(cross(at - from, to - at), normal_) < -4.0 * tolerance_ * length(to - from);
}

// Makes the union of p and q, which share edge i of p; false when their common boundary is not one chain.
bool PolygonMerger::join(std::uint32_t p, std::uint32_t q, std::size_t i, GrowingPolygon& result) const {
  const GrowingPolygon& a = polygons_[p];
  const GrowingPolygon& b = polygons_[q];
  const std::size_t n = a.loop.size(), m = b.loop.size();
  // A place on a loop, which may be past its end by less than all of it.
  const auto wrapped = [](std::size_t at, std::size_t size) { return at < size ? at : at - size; };
  std::size_t first = i;  // the chain of common edges in a: [first, last]
  std::size_t count = 1;
  while (count < n && beyond(p, wrapped(first + n - 1, n)) == q) {
    first = wrapped(first + n - 1, n);
    ++count;
  }
  while (count < n && beyond(p, wrapped(first + count, n)) == q) {
    ++count;
  }
  const std::uint32_t chain_start = a.loop[first], chain_end = a.loop[wrapped(first + count, n)];
  const auto positionIn = [](const GrowingPolygon& polygon, std::uint32_t vertex) {
    const auto found = std::find(polygon.loop.begin(), polygon.loop.end(), vertex);
    return static_cast<std::size_t>(found - polygon.loop.begin());
  };
  const std::size_t start_b = positionIn(b, chain_start), end_b = positionIn(b, chain_end);
  // Most candidates turn the wrong way where the two boundaries meet: known before anything is built.
  if (start_b == m || end_b == m ||
      turnsRight(a.loop[wrapped(first + n - 1, n)], chain_start, b.loop[wrapped(start_b + 1, m)]) ||
      turnsRight(b.loop[wrapped(end_b + m - 1, m)], chain_end,
                 a.loop[wrapped(wrapped(first + count, n) + 1, n)])) {
    return false;
  }
  const std::uint32_t shorter = n < m ? p : q, longer = n < m ? q : p;
  std::size_t common = 0;
  for (std::size_t k = 0; k < std::min(n, m); ++k) {
    common += beyond(shorter, k) == longer ? 1 : 0;
  }
  if (common != count || count >= n || count >= m) {
    return false;
  }
  result.loop.clear();
  for (std::size_t k = 0; k < n - count; ++k) {
    result.loop.push_back(a.loop[wrapped(wrapped(first + count, n) + k, n)]);
  }
  // a's part ends just before chain_start; b's part runs from chain_start to the chain's end.
  for (std::size_t k = 0; k < m - count; ++k) {
    result.loop.push_back(b.loop[wrapped(start_b + k, m)]);
  }
  result.slack = std::max(a.slack, b.slack);
  result.triangle_count = a.triangle_count + b.triangle_count;
  return true;
}

bool PolygonMerger::mergeBest(std::uint32_t p) {
  std::uint32_t best_partner = kNone;
  double best_score = 0.0;
  std::uint32_t previous = kNone;
  for (std::size_t i = 0; i < polygons_[p].loop.size(); ++i) {
    const std::uint32_t q = beyond(p, i);
    if (q == kNone || q == previous) {
      continue;
    }
    previous = q;
    if (!join(p, q, i, candidate_) || !finisher_.finish(candidate_)) {
      continue;
    }
    const double score = compactness(candidate_);
    if (best_partner == kNone || score > best_score) {
      std::swap(best_, candidate_);
      best_partner = q;
      best_score = score;
    }
  }
  if (best_partner == kNone) {
    return false;
  }
  claimEdges(polygons_[best_partner].loop, p);
  polygons_[best_partner].loop.clear();
  std::swap(polygons_[p], best_);
  --alive_;
  return true;
}

double PolygonFinisher::distanceToLine(const Point2& p, const Point2& a, const Point2& b) {
  const double dx = b.x - a.x, dy = b.y - a.y;
  const double l = std::sqrt(dx * dx + dy * dy);
  return l > 0.0 ? (dx * (p.y - a.y) - dy * (p.x - a.x)) / l : 0.0;
}

// Corners: where leaving the vertex out would move the boundary by more than the tolerance.
int PolygonFinisher::markCorners(std::vector<std::uint32_t>& corners) const {
  const std::size_t n = points_.size();
  corners.clear();
  // Start at an extreme vertex, which is a corner for sure.
  std::size_t start = 0;
  for (std::size_t i = 1; i < n; ++i) {
    if (points_[i].x < points_[start].x ||
        (points_[i].x == points_[start].x && points_[i].y < points_[start].y)) {
      start = i;
    }
  }
  corners.push_back(static_cast<std::uint32_t>(start));
  for (std::size_t k = 1; k < n; ++k) {
    const std::size_t i = start + k < n ? start + k : start + k - n;
    const Point2& next = points_[i + 1 < n ? i + 1 : 0];
    const double turn = -distanceToLine(points_[i], points_[corners.back()], next);
    if (turn < -tolerance_) {
      return -1;
    }
    if (turn > tolerance_) {
      corners.push_back(static_cast<std::uint32_t>(i));
    }
  }
  return static_cast<int>(corners.size());
}

// Convex, once around, and all of the boundary within the tolerance of the polygon through the corners.
bool PolygonFinisher::cornersDescribe(std::span<const std::uint32_t> corners, double& slack) const {
  const std::size_t n = points_.size(), c = corners.size();
  const auto after = [n](std::size_t i) { return i + 1 < n ? i + 1 : 0; };
  // All corners turn left, by less than half a turn each. So the boundary has gone once around when its
  // direction has come from below the axis to above it once.
  std::uint32_t turns = 0;
  for (std::size_t i = 0; i < c; ++i) {
    const std::size_t end = corners[i + 1 < c ? i + 1 : 0];
    const Point2 &a = points_[corners[i]], &b = points_[end], &d = points_[corners[(i + 2) % c]];
    const double ux = b.x - a.x, uy = b.y - a.y, vx = d.x - b.x, vy = d.y - b.y;
    if (!(ux * vy - uy * vx > 0.0)) {
      return false;
    }
    const bool from_above = uy > 0.0 || (uy == 0.0 && ux > 0.0);
    const bool to_above = vy > 0.0 || (vy == 0.0 && vx > 0.0);
    turns += !from_above && to_above ? 1 : 0;
    // Each vertex between two corners stands for a point of the edge, in the same order: the nearest one that
    // is not before the last. Otherwise a boundary that runs back beside itself would pass for an edge.
    const double size = std::sqrt(ux * ux + uy * uy);
    double reached = 0.0;
    for (std::size_t k = after(corners[i]); k != end; k = after(k)) {
      const double along = (ux * (points_[k].x - a.x) + uy * (points_[k].y - a.y)) / size;
      reached = std::clamp(along, reached, size);
      const double beside = std::abs(distanceToLine(points_[k], a, b));
      slack = std::max(slack, along == reached ? beside : std::hypot(beside, along - reached));
    }
  }
  return turns == 1 && slack <= 2.0 * tolerance_;
}

void PolygonFinisher::setPlane(const Plane& plane, double tolerance) {
  tolerance_ = tolerance;
  const Vec3d& normal = plane.normal;
  u_ = normalized(cross(std::abs(normal.x) < 0.7 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0), normal));
  v_ = cross(normal, u_);
}

bool PolygonFinisher::finish(GrowingPolygon& polygon) {
  const Vec3d origin(positions_[polygon.loop[0]]);
  points_.clear();
  for (const std::uint32_t id : polygon.loop) {
    const Vec3d p = Vec3d(positions_[id]) - origin;
    points_.push_back({dot(p, u_), dot(p, v_)});
  }
  const int corner_count = markCorners(polygon.corners);
  if (corner_count < 3 || corner_count > static_cast<int>(max_vertices_)) {
    return false;
  }
  double boundary_slack = 0.0;
  if (!cornersDescribe(polygon.corners, boundary_slack)) {
    return false;
  }
  // Area and centroid of the fan around the first vertex.
  double area = 0.0, x = 0.0, y = 0.0;
  for (std::size_t i = 1; i + 1 < points_.size(); ++i) {
    const Point2 &a = points_[i], &b = points_[i + 1];
    const double part = 0.5 * (a.x * b.y - a.y * b.x);
    area += part;
    x += part * (a.x + b.x) / 3.0;
    y += part * (a.y + b.y) / 3.0;
  }
  if (!(area > 0.0)) {
    return false;
  }
  polygon.area = area;
  polygon.centroid = origin + u_ * (x / area) + v_ * (y / area);
  polygon.slack = std::max(polygon.slack, boundary_slack);
  return true;
}

}  // namespace sightline::occluders
