#include "sightline/layers/hull.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "src/layers/hull/hull_flat.h"
#include "src/layers/hull/hull_frame.h"
#include "src/layers/hull/hull_solid.h"
#include "src/layers/hull/hull_starts.h"

namespace sightline {
namespace {

constexpr std::size_t kMaxPoints = std::size_t{1} << 24;
constexpr double kLargestCoordinate = 1e100;

Status check(std::span<const Vec3d> points) {
  if (points.empty()) {
    return Error{"a hull needs at least one point"};
  }
  if (points.size() > kMaxPoints) {
    return Error{"a hull is made of at most 2^24 points, not of " + std::to_string(points.size())};
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!isFinite(points[i]) || maxComponent(abs(points[i])) > kLargestCoordinate) {
      return Error{"point " + std::to_string(i) + " of a hull is not finite or beyond 1e100"};
    }
  }
  return Success{};
}

// Exponent of the power of two above the largest coordinate. Scaled by it, products of three coordinates
// neither overflow nor underflow.
int exponentOf(std::span<const Vec3d> points) {
  double largest = 0.0;
  for (const Vec3d& p : points) {
    largest = std::max(largest, maxComponent(abs(p)));
  }
  return largest > 0.0 ? std::ilogb(largest) + 1 : 0;
}

void setBall(ConvexHull& hull) {
  const Vec3d first = hull.vertices[0];
  Vec3d sum;
  for (const Vec3d& v : hull.vertices) {
    sum += v - first;
  }
  hull.centre = first + sum / static_cast<double>(hull.vertices.size());
  for (const Vec3d& v : hull.vertices) {
    hull.radius = std::max(hull.radius, length(v - hull.centre));
  }
}

double roundedUp(double value, double scale) {
  return value > 0.0 ? value * scale * (1.0 + 0x1p-48) + 4.0 * std::numeric_limits<double>::denorm_min()
                     : 0.0;
}

// Replaces the scaled coordinates by the given ones.
void restore(ConvexHull& hull, std::span<const Vec3d> given, std::span<const std::uint32_t> numbers,
             double scale) {
  for (std::size_t v = 0; v < numbers.size(); ++v) {
    hull.vertices[v] = given[numbers[v]];
  }
  for (Plane& face : hull.faces) {
    face.offset *= scale;
  }
  hull.centre = hull.centre * scale;
  hull.radius = roundedUp(hull.radius, scale);
  hull.slack = roundedUp(hull.slack, scale);
}

void packNeighbours(ConvexHull& hull) {
  hull.first_quad.assign(1, 0);
  for (std::uint32_t v = 0; v < hull.vertices.size(); ++v) {
    const std::uint32_t first = hull.first_neighbour[v], last = hull.first_neighbour[v + 1];
    for (std::uint32_t quad = first; quad < last; quad += 4) {
      for (int axis = 0; axis < 3; ++axis) {
        for (std::uint32_t i = quad; i < quad + 4; ++i) {
          hull.neighbour_quads.push_back(hull.vertices[i < last ? hull.neighbours[i] : v][axis]);
        }
      }
    }
    hull.first_quad.push_back(static_cast<std::uint32_t>(hull.neighbour_quads.size() / 12));
  }
}

ConvexHull hullOf(std::span<const Vec3d> given) {
  const int exponent = exponentOf(given);
  std::vector<Vec3d> points;
  points.reserve(given.size());
  for (const Vec3d& p : given) {
    points.emplace_back(std::ldexp(p.x, -exponent), std::ldexp(p.y, -exponent), std::ldexp(p.z, -exponent));
  }
  std::vector<std::uint32_t> numbers(points.size());
  std::iota(numbers.begin(), numbers.end(), 0u);
  layers::HullFrame frame = layers::hullFrame(points, numbers);
  std::optional<ConvexHull> hull;
  if (frame.dimension == 3) {
    hull = layers::solidHull(points, frame, numbers);
    frame.dimension = 2;
  }
  if (!hull) {
    hull = layers::flatHull(points, frame, numbers);
  }
  setBall(*hull);
  restore(*hull, given, numbers, std::ldexp(1.0, exponent));
  packNeighbours(*hull);
  layers::findStarts(*hull);
  return *std::move(hull);
}

}  // namespace

Result<ConvexHull> buildHull(std::span<const Vec3d> points) {
  if (const Status checked = check(points); !checked) {
    return checked.error();
  }
  try {
    return hullOf(points);
  } catch (const std::bad_alloc&) {
    return Error{"no memory for the hull of " + std::to_string(points.size()) + " points"};
  }
}

}  // namespace sightline
