#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

#include "sightline/occluders/occluder_set.h"
#include "src/occluders/assemble_set.h"
#include "src/occluders/bodies.h"
#include "src/occluders/divide_outlines.h"
#include "src/occluders/occluder_limits.h"
#include "src/occluders/polygon_merge.h"

namespace sightline {
namespace {

using occluders::FoundPolygon;
using occluders::RankedPolygon;

constexpr std::uint32_t kMostCorners = 64;

// The polygons of a program that can be occluders.
struct SoundPolygons {
  occluders::IdStore ids;
  std::vector<FoundPolygon> polygons;
  std::vector<ObjectId> object_of;  // by polygon
  std::vector<double> largest;      // by polygon: the largest coordinate of its vertices, without its sign
};

// The corners of all polygons, one after the other. Equal ones get one vertex id, as in a welded mesh.
Scene cornersOf(std::span<const OccluderPolygon> polygons) {
  Scene corners;
  for (const OccluderPolygon& polygon : polygons) {
    for (const Vec3f& vertex : polygon.vertices) {
      corners.indices.push_back(static_cast<std::uint32_t>(corners.positions.size()));
      corners.positions.push_back(vertex);
    }
  }
  weldPositions(corners);
  return corners;
}

// Nothing if the polygon has no area, or a vertex is not finite.
std::optional<Plane> planeOf(std::span<const Vec3f> vertices, double largest) {
  Vec3d normal;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Vec3d origin(vertices[0]);
    normal += cross(Vec3d(vertices[i]) - origin, Vec3d(vertices[(i + 1) % vertices.size()]) - origin);
  }
  if (vertices.size() < 3 || !std::isfinite(largest) || !(length(normal) > 0.0)) {
    return std::nullopt;
  }
  const Vec3d unit = normalized(normal);
  return Plane{unit, -dot(unit, Vec3d(vertices[0]))};
}

// Polygons that are not flat or not convex are counted as degenerate.
SoundPolygons soundOnesOf(std::span<const OccluderPolygon> polygons, const Scene& corners,
                          OccluderReport& report) {
  SoundPolygons sound;
  occluders::PolygonFinisher finisher(corners.positions, kMostCorners);
  auto corner = corners.indices.begin();
  for (const OccluderPolygon& polygon : polygons) {
    occluders::GrowingPolygon outline;
    double largest = 0.0;
    for (const Vec3f& vertex : polygon.vertices) {
      outline.loop.push_back(*corner++);
      largest = std::max(largest, static_cast<double>(maxComponent(abs(vertex))));
    }
    const std::optional<Plane> plane = planeOf(polygon.vertices, largest);
    if (!plane) {
      ++report.degenerate;
      continue;
    }
    for (const Vec3f& vertex : polygon.vertices) {
      outline.slack = std::max(outline.slack, std::abs(plane->evaluate(Vec3d(vertex))));
    }
    outline.triangle_count = static_cast<std::uint32_t>(outline.loop.size() - 2);
    const double tolerance = occluders::roundingTolerance(largest);
    finisher.setPlane(*plane, tolerance);
    if (outline.slack > tolerance || !finisher.finish(outline)) {
      ++report.degenerate;
      continue;
    }
    sound.polygons.push_back(occluders::foundPolygon(outline, *plane, sound.ids));
    sound.polygons.back().double_sided = polygon.double_sided;
    sound.object_of.push_back(polygon.object);
    sound.largest.push_back(largest);
    report.used += outline.triangle_count;
  }
  return sound;
}

// By object, with ids by area, the largest first.
std::vector<RankedPolygon> rank(const SoundPolygons& sound) {
  std::vector<std::uint32_t> by_area(sound.polygons.size());
  std::iota(by_area.begin(), by_area.end(), 0u);
  std::stable_sort(by_area.begin(), by_area.end(), [&](std::uint32_t a, std::uint32_t b) {
    return sound.polygons[a].area > sound.polygons[b].area;
  });
  std::vector<RankedPolygon> ranked;
  for (std::size_t id = 0; id < by_area.size(); ++id) {
    ranked.push_back({&sound.polygons[by_area[id]], sound.object_of[by_area[id]], OccluderId(id)});
  }
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const RankedPolygon& a, const RankedPolygon& b) { return a.object < b.object; });
  return ranked;
}

// Finds the bodies among the polygons of each object.
void findBodies(const Scene& corners, std::span<const RankedPolygon> by_object, SoundPolygons& sound) {
  occluders::BodyFinder bodies(corners.positions);
  std::vector<FoundPolygon*> of_object;
  double largest = 0.0;
  for (std::size_t i = 0; i < by_object.size(); ++i) {
    const auto polygon = static_cast<std::size_t>(by_object[i].polygon - sound.polygons.data());
    of_object.push_back(&sound.polygons[polygon]);
    largest = std::max(largest, sound.largest[polygon]);
    if (i + 1 == by_object.size() || by_object[i + 1].object != by_object[i].object) {
      bodies.find(of_object, occluders::roundingTolerance(largest));
      of_object.clear();
      largest = 0.0;
    }
  }
}

}  // namespace

OccluderSet makeOccluders(std::span<const OccluderPolygon> polygons) {
  const Scene corners = cornersOf(polygons);
  OccluderSet set;
  SoundPolygons sound = soundOnesOf(polygons, corners, set.report);
  std::vector<RankedPolygon> ranked = rank(sound);
  findBodies(corners, ranked, sound);
  for (const RankedPolygon& polygon : ranked) {
    if (polygon.object.valid() && (set.objects.empty() || set.objects.back() != polygon.object)) {
      set.objects.push_back(polygon.object);
    }
  }
  occluders::DividedOutlines divided;
  occluders::divideOutlines(corners.positions, serialFor, ranked, divided);
  occluders::assembleSet(corners.positions, ranked, serialFor, set);
  return set;
}

}  // namespace sightline
