// Based on: Swinbank, Purser. Fibonacci grids: A novel approach to global modelling. Quarterly Journal of the
// Royal Meteorological Society 132, 2006. Point i of n has the height 1 - (2 i + 1) / n and is turned by the
// golden angle against point i - 1. Differs from the paper in: the points run from pole to pole, and their
// azimuths come from repeated rotation, so that every platform gets the same bits.

#include "src/occluders/database/sphere_directions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "src/math/longest_axis.h"

namespace sightline::occluders {
namespace {

constexpr double kCosGoldenAngle = -0.7373688780783197;
constexpr double kSinGoldenAngle = 0.6754902942615238;
constexpr double kTexelsPerDirection = 16.0;
constexpr double kCosineRounding = 1e-9;  // far above that of a scalar product, far below the texels' size

double angleBetween(const Vec3d& unit_a, const Vec3d& unit_b) {
  return std::acos(std::clamp(dot(unit_a, unit_b), -1.0, 1.0));
}

// Faces 0 to 5: +x, -x, +y, -y, +z, -z.
Vec3d pointOnCube(std::uint32_t face, double u, double v) {
  const int axis = static_cast<int>(face / 2);
  Vec3d point;
  point[axis] = face % 2 == 0 ? 1.0 : -1.0;
  point[(axis + 1) % 3] = u;
  point[(axis + 2) % 3] = v;
  return point;
}

}  // namespace

// A square of a cube's face.
struct SphereDirections::Quad {
  std::uint32_t face = 0;
  double u = 0.0, v = 0.0, size = 2.0;  // its lowest corner and its edge

  Vec3d center() const { return normalized(pointOnCube(face, u + 0.5 * size, v + 0.5 * size)); }
  std::array<Vec3d, 4> corners() const {
    return {pointOnCube(face, u, v), pointOnCube(face, u + size, v), pointOnCube(face, u, v + size),
            pointOnCube(face, u + size, v + size)};
  }
  // Its largest angle from the centre: that of a corner, as it is a convex figure on the sphere.
  double radius() const {
    double largest = 0.0;
    for (const Vec3d& corner : corners()) {
      largest = std::max(largest, angleBetween(center(), normalized(corner)));
    }
    return largest;
  }
};

SphereDirections::SphereDirections(std::uint32_t count) {
  const std::uint32_t n = std::clamp(count, 1u, kMaxDirections);
  double c = 1.0, s = 0.0;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double height = 1.0 - (2.0 * i + 1.0) / n;
    const double radius = std::sqrt(1.0 - height * height);
    directions_.push_back(normalized(Vec3d(radius * c, height, radius * s)));
    const double turned = c * kCosGoldenAngle - s * kSinGoldenAngle;
    s = c * kSinGoldenAngle + s * kCosGoldenAngle;
    c = turned;
  }
  buildTable();
  covering_angle_ = boundCoveringAngle();
}

void SphereDirections::buildTable() {
  texels_per_edge_ = static_cast<std::uint32_t>(std::ceil(std::sqrt(kTexelsPerDirection * count() / 6.0)));
  const double size = 2.0 / texels_per_edge_;
  for (std::uint32_t face = 0; face < 6; ++face) {
    for (std::uint32_t row = 0; row < texels_per_edge_; ++row) {
      for (std::uint32_t column = 0; column < texels_per_edge_; ++column) {
        appendCandidates({face, -1.0 + column * size, -1.0 + row * size, size});
        candidates_.endRow();
      }
    }
  }
  candidates_.shrinkToFit();
}

// All that can be nearest somewhere in the texel. Whatever is nearest within radius r of a centre, whose
// nearest direction is at the angle m, is at most m + 2 r from the centre. Of those, i drops out if some j
// is nearer in all of the texel: (j - i) . x > 0 at the four corners, hence at all x between them.
void SphereDirections::appendCandidates(const Quad& texel) {
  const Vec3d center = texel.center();
  double best = -1.0;
  for (const Vec3d& direction : directions_) {
    best = std::max(best, dot(center, direction));
  }
  const double reach = std::acos(std::min(best, 1.0)) + 2.0 * texel.radius();
  const double min_cosine = reach < std::numbers::pi ? std::cos(reach) - kCosineRounding : -2.0;
  std::vector<std::uint16_t> near;
  for (std::uint32_t i = 0; i < count(); ++i) {
    if (dot(center, directions_[i]) >= min_cosine) {
      near.push_back(static_cast<std::uint16_t>(i));
    }
  }
  const std::array<Vec3d, 4> corners = texel.corners();
  for (const std::uint16_t i : near) {
    const bool beaten = std::any_of(near.begin(), near.end(), [&](std::uint16_t j) {
      const Vec3d difference = directions_[j] - directions_[i];
      return std::all_of(corners.begin(), corners.end(),
                         [&](const Vec3d& corner) { return dot(difference, corner) > kCosineRounding; });
    });
    if (!beaten) {
      candidates_.add(i);
    }
  }
}

std::uint32_t SphereDirections::nearest(const Vec3d& direction) const {
  const Vec3d size = abs(direction);
  const double largest = maxComponent(size);
  if (!isFinite(direction) || !(largest > 0.0)) {
    return 0;
  }
  const int axis = math::longestAxis(size);
  const Vec3d on_cube = direction / largest;
  const std::uint32_t last = texels_per_edge_ - 1;
  const auto texelAlong = [&](double coordinate) {
    return std::min(last, static_cast<std::uint32_t>((coordinate + 1.0) * 0.5 * texels_per_edge_));
  };
  const std::uint32_t face = 2u * static_cast<std::uint32_t>(axis) + (direction[axis] < 0.0 ? 1u : 0u);
  const std::uint32_t column = texelAlong(on_cube[(axis + 1) % 3]);
  const std::uint32_t row = texelAlong(on_cube[(axis + 2) % 3]);
  const std::uint32_t texel = (face * texels_per_edge_ + row) * texels_per_edge_ + column;
  const std::span<const std::uint16_t> candidates = candidates_[texel];
  std::uint32_t best = candidates[0];
  double best_cosine = dot(directions_[best], on_cube);
  for (const std::uint16_t candidate : candidates.subspan(1)) {
    const double cosine = dot(directions_[candidate], on_cube);
    if (cosine > best_cosine) {
      best = candidate;
      best_cosine = cosine;
    }
  }
  return best;
}

// Branch and bound over squares of the cube's faces: the angle to the nearest direction changes by no more
// than the angle gone, so that within a square it is at most that of the centre plus the square's radius.
double SphereDirections::boundCoveringAngle() const {
  const double tolerance = 0.02 * 2.0 / std::sqrt(static_cast<double>(count()));
  double found = 0.0;
  std::vector<Quad> open;
  for (std::uint32_t face = 0; face < 6; ++face) {
    open.push_back({face, -1.0, -1.0, 2.0});
  }
  while (!open.empty()) {
    const Quad quad = open.back();
    open.pop_back();
    const Vec3d center = quad.center();
    const double angle = angleBetween(center, directions_[nearest(center)]);
    found = std::max(found, angle);
    if (angle + quad.radius() > found + tolerance) {
      const double half = 0.5 * quad.size;
      for (const double u : {quad.u, quad.u + half}) {
        for (const double v : {quad.v, quad.v + half}) {
          open.push_back({quad.face, u, v, half});
        }
      }
    }
  }
  return std::min(std::numbers::pi, found + tolerance);
}

std::size_t SphereDirections::bytes() const {
  return directions_.capacity() * sizeof(Vec3d) + candidates_.bytes();
}

}  // namespace sightline::occluders
