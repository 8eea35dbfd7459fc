// Divides the piece with the largest hull in two, again and again, by the plane across an axis that leaves
// the least surface of hulls, and joins again what was divided in vain. The surface of a convex hull is
// proportional to the share of lines that hit it (Cauchy, Crofton), so this is the chance that the hulls make
// an occlusion that the mesh does not.
//
// Differs from V-HACD and CoACD in: pieces are of the surface, which is all that is drawn, not of the volume;
// no point of the mesh is left out, however thin it is.

#include "sightline/layers/convex_pieces.h"
#include "src/geometry/clip_convex.h"
#include "src/math/longest_axis.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <new>
#include <optional>
#include <string>
#include <utility>

namespace sightline {
namespace {

using Polygon = std::vector<Vec3d>;

// Beyond this many polygons a piece is divided in the middle of its longest side.
constexpr std::size_t kManyPolygons = 20000;

struct Piece {
  std::vector<Polygon> polygons;  // only of pieces that are not divided
  ConvexHull hull;
  double surface = 0.0;                 // of the hull
  std::uint32_t first = 0, second = 0;  // the pieces that it was divided into; 0: it was not
  bool is_final = false;                // nothing divides it
};

double surfaceOf(const ConvexHull& hull) {
  double twice = 0.0;
  const auto add = [&](const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    twice += length(cross(b - a, c - a));
  };
  for (const auto& [a, b, c] : hull.triangles) {
    add(hull.vertices[a], hull.vertices[b], hull.vertices[c]);
  }
  if (hull.dimension != 2) {
    return 0.5 * twice;
  }
  // Both sides of a flat hull, whose vertices' neighbours go round its outline.
  std::uint32_t before = 0, at = hull.neighbours[hull.first_neighbour[0]];
  while (at != 0) {
    const std::uint32_t one = hull.neighbours[hull.first_neighbour[at]];
    const std::uint32_t next = one != before ? one : hull.neighbours[hull.first_neighbour[at] + 1];
    add(hull.vertices[0], hull.vertices[at], hull.vertices[next]);
    before = std::exchange(at, next);
  }
  return twice;
}

Result<Piece> pieceOf(std::vector<Polygon> polygons) {
  std::vector<Vec3d> points;
  for (const Polygon& polygon : polygons) {
    points.insert(points.end(), polygon.begin(), polygon.end());
  }
  Result<ConvexHull> hull = buildHull(points);
  if (!hull) {
    return hull.error();
  }
  Piece piece{.polygons = std::move(polygons), .hull = std::move(*hull)};
  piece.surface = surfaceOf(piece.hull);
  return piece;
}

// The parts of a polygon below and above a plane across an axis. What lies in the plane alone is below.
void cut(const Polygon& polygon, int axis, double at, std::vector<Polygon>& below,
         std::vector<Polygon>& above) {
  const auto height = [&](const Vec3d& p) { return p[axis] - at; };
  const auto crossing = [&](const Vec3d& p, const Vec3d& q, double height_p, double /*height_q*/) {
    Vec3d between = p + (q - p) * (-height_p / (q[axis] - p[axis]));
    between[axis] = at;
    return between;
  };
  geometry::DividedPolygon divided = geometry::divideConvex(polygon, height, crossing);
  if (divided.reaches_behind || !divided.reaches_front) {
    below.push_back(std::move(divided.behind));
  }
  if (divided.reaches_front) {
    above.push_back(std::move(divided.front));
  }
}

using Halves = std::pair<Piece, Piece>;

std::optional<Halves> halvesOf(const Piece& piece, int axis, double at) {
  std::vector<Polygon> below, above;
  for (const Polygon& polygon : piece.polygons) {
    cut(polygon, axis, at, below, above);
  }
  if (below.empty() || above.empty()) {
    return std::nullopt;
  }
  Result<Piece> low = pieceOf(std::move(below)), high = pieceOf(std::move(above));
  if (!low || !high) {
    return std::nullopt;
  }
  return Halves{std::move(*low), std::move(*high)};
}

// The two halves with the least surface, of some planes across the axes.
std::optional<Halves> bestHalves(const Piece& piece) {
  Vec3d low = piece.hull.vertices[0], high = low;
  for (const Vec3d& vertex : piece.hull.vertices) {
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], vertex[axis]);
      high[axis] = std::max(high[axis], vertex[axis]);
    }
  }
  const Vec3d size = high - low;
  const int longest = math::longestAxis(size);
  const bool has_many = piece.polygons.size() > kManyPolygons;
  std::optional<Halves> best;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double share : {0.5, 0.25, 0.75}) {
      if (!(size[axis] > 0.0) || (has_many && (axis != longest || share != 0.5))) {
        continue;
      }
      std::optional<Halves> halves = halvesOf(piece, axis, low[axis] + size[axis] * share);
      const auto surface = [](const Halves& h) { return h.first.surface + h.second.surface; };
      if (halves && (!best || surface(*halves) < surface(*best))) {
        best = std::move(halves);
      }
    }
  }
  return best;
}

// Divides the first piece until there are so many pieces that are not divided.
void divide(std::uint32_t max_pieces, std::vector<Piece>& pieces) {
  for (std::uint32_t count = 1; count < max_pieces;) {
    Piece* largest = nullptr;
    for (Piece& piece : pieces) {
      if (piece.first == 0 && !piece.is_final && (largest == nullptr || piece.surface > largest->surface)) {
        largest = &piece;
      }
    }
    if (largest == nullptr) {
      return;
    }
    std::optional<Halves> halves = bestHalves(*largest);
    if (!halves) {
      largest->is_final = true;
      continue;
    }
    largest->polygons.clear();
    largest->first = static_cast<std::uint32_t>(pieces.size());
    largest->second = largest->first + 1;
    pieces.push_back(std::move(halves->first));
    pieces.push_back(std::move(halves->second));
    ++count;
  }
}

// Joins what was divided in vain: pieces come after those that they were divided from.
void join(std::vector<Piece>& pieces) {
  std::vector<double> least(pieces.size());  // surface of a piece or of all that it was divided into
  for (std::size_t i = pieces.size(); i-- > 0;) {
    Piece& piece = pieces[i];
    const double divided = piece.first == 0 ? piece.surface : least[piece.first] + least[piece.second];
    // Rounding alone is no gain.
    const bool gains = divided < piece.surface * (1.0 - 1e-9);
    piece.first = gains ? piece.first : 0;
    least[i] = gains ? divided : piece.surface;
  }
}

void collect(const std::vector<Piece>& pieces, std::uint32_t from, double slack,
             std::vector<ConvexHull>& hulls) {
  const Piece& piece = pieces[from];
  if (piece.first != 0) {
    collect(pieces, piece.first, slack, hulls);
    collect(pieces, piece.second, slack, hulls);
    return;
  }
  hulls.push_back(piece.hull);
  hulls.back().slack += slack;
}

Result<std::vector<ConvexHull>> divided(std::vector<Polygon> polygons, std::uint32_t max_pieces) {
  Result<Piece> whole = pieceOf(std::move(polygons));
  if (!whole) {
    return whole.error();
  }
  double reach = 0.0;
  for (const Vec3d& vertex : whole->hull.vertices) {
    reach = std::max(reach, maxComponent(abs(vertex)));
  }
  std::vector<Piece> pieces;
  pieces.push_back(std::move(*whole));
  divide(max_pieces, pieces);
  join(pieces);
  // A point between is off by a few roundings, and is cut at most once for each piece.
  const double slack = pieces[0].first == 0 ? 0.0 : 0x1p-50 * reach * static_cast<double>(pieces.size());
  std::vector<ConvexHull> hulls;
  collect(pieces, 0, slack, hulls);
  return hulls;
}

}  // namespace

Result<std::vector<ConvexHull>> convexPieces(std::span<const Vec3d> positions,
                                             std::span<const std::array<std::uint32_t, 3>> triangles,
                                             const ConvexPieceSettings& settings) {
  if (triangles.empty()) {
    return Error{"no triangles to divide into pieces"};
  }
  try {
    std::vector<Polygon> polygons;
    for (const auto& [a, b, c] : triangles) {
      if (std::max({a, b, c}) >= positions.size()) {
        return Error{"triangle " + std::to_string(polygons.size()) + " has a corner that is none of the " +
                     std::to_string(positions.size()) + " positions"};
      }
      polygons.push_back({positions[a], positions[b], positions[c]});
    }
    return divided(std::move(polygons), std::clamp(settings.max_pieces, 1u, kMaxConvexPieces));
  } catch (const std::bad_alloc&) {
    return Error{"no memory for the pieces of " + std::to_string(triangles.size()) + " triangles"};
  }
}

}  // namespace sightline
