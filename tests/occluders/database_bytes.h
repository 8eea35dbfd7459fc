#pragma once

// Asking the two occluder databases in one way, for tests of their bytes.

#include <gtest/gtest.h>

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "sightline/comparison/viewpoint_database.h"
#include "sightline/occluders/occluder_database.h"
#include "tests/occluders/flat_mesh.h"

namespace sightline::database_bytes {

using flat_mesh::Random;
using Bytes = std::vector<std::byte>;
using Ids = std::vector<OccluderId>;

inline constexpr double kInf = std::numeric_limits<double>::infinity();
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// Names for both databases' places: what lists are made for.
inline std::uint32_t placeCount(const OccluderDatabase& database) {
  return database.cellCount();
}
inline std::uint32_t placeCount(const ViewpointDatabase& database) {
  return database.pointCount();
}
inline std::uint32_t placeOf(const OccluderDatabase& database, const Vec3d& viewpoint) {
  return database.cellOf(viewpoint);
}
inline std::uint32_t placeOf(const ViewpointDatabase& database, const Vec3d& viewpoint) {
  return database.nearestPoint(viewpoint);
}
inline void expectSamePlace(const OccluderDatabase& a, const OccluderDatabase& b, std::uint32_t place) {
  EXPECT_EQ(a.cellRegion(place), b.cellRegion(place));
}
inline void expectSamePlace(const ViewpointDatabase& a, const ViewpointDatabase& b, std::uint32_t place) {
  EXPECT_EQ(a.point(place), b.point(place));
}
inline void expectSameMeasures(const OccluderDatabase& a, const OccluderDatabase& b) {
  EXPECT_EQ(a.coveringAngle(), b.coveringAngle());
}
inline void expectSameMeasures(const ViewpointDatabase& a, const ViewpointDatabase& b) {
  EXPECT_EQ(a.spacing(), b.spacing());
}

template <typename Database>
Ids listOf(const Database& database, std::uint32_t place, std::uint32_t direction) {
  const auto list = database.list(place, direction);
  return {list.begin(), list.end()};
}

// Viewpoints in the box, around it, far away and not finite.
inline std::vector<Vec3d> viewpoints(const Box& box, Random& random) {
  std::vector<Vec3d> points{{0, 0, 0}, {kNan, kNan, kNan}, {kInf, 0, -kInf}, {1e300, -1e300, 1e300}};
  const Vec3d middle = center(box), extent(box.extent());
  for (int i = 0; i < 300; ++i) {
    const Vec3d p = random.point(0.7);
    points.push_back(middle + Vec3d(p.x * extent.x, p.y * extent.y, p.z * extent.z));
  }
  return points;
}

template <typename Database>
std::string errorOf(const Bytes& bytes, std::uint32_t occluder_count) {
  const auto loaded = Database::load(bytes, occluder_count);
  return loaded ? "none" : loaded.error().message;
}

inline bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

// Asks for all there is, and more: a sanitizer sees what is read beyond the end.
template <typename Database>
void askEverything(const Database& database, std::uint32_t occluders, Random& random) {
  const auto expectSound = [&](std::span<const OccluderId> list) {
    for (const OccluderId id : list) {
      ASSERT_LT(id.value, occluders);
    }
  };
  for (std::uint32_t place = 0; place < placeCount(database); ++place) {
    expectSamePlace(database, database, place);
    for (std::uint32_t d = 0; d < database.directionCount(); ++d) {
      expectSound(database.list(place, d));
    }
  }
  for (std::uint32_t d = 0; d < database.directionCount(); ++d) {
    EXPECT_NEAR(length(database.direction(d)), 1.0, 1e-9);
  }
  for (const Vec3d& viewpoint : viewpoints({{-50, -50, -50}, {50, 50, 50}}, random)) {
    ASSERT_LT(placeOf(database, viewpoint), placeCount(database));
    expectSound(database.find(viewpoint, random.point(1.0)));
  }
}

}  // namespace sightline::database_bytes
