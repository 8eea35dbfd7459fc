#include <algorithm>
#include <map>
#include <utility>

#include "sightline/base/large_vector.h"
#include "sightline/occluders/occluder_set.h"
#include "src/occluders/bodies.h"
#include "src/occluders/links.h"
#include "src/occluders/polygon_merge.h"

namespace sightline {
namespace {

using occluders::FoundPolygon;
using occluders::RankedPolygon;

struct ObjectResult {
  std::vector<FoundPolygon> polygons;
  OccluderReport report;
};

ObjectResult findInObject(const SceneView& scene, const Object& object, std::uint32_t max_vertices) {
  ObjectResult result;
  const Material& material = scene.materialOf(object);
  if (!material.opaque()) {
    result.report.see_through = object.triangleCount();
    return result;
  }
  if (object.mark == OccluderMark::kNever) {
    result.report.marked_never = object.triangleCount();
    return result;
  }
  const double largest = maxComponent(max(abs(Vec3d(object.bounds.min)), abs(Vec3d(object.bounds.max))));
  if (!std::isfinite(largest)) {
    result.report.degenerate = object.triangleCount();
    return result;
  }
  const double tolerance = occluders::roundingTolerance(largest);
  const auto found =
      occluders::findPatches(scene.positions, scene.indicesOf(object), material.double_sided, tolerance);
  std::uint64_t in_polygons = 0;
  for (const occluders::Patch& patch : found.patches) {
    for (FoundPolygon& polygon : occluders::mergePatch(scene.positions, patch, tolerance, max_vertices)) {
      polygon.double_sided = material.double_sided;
      in_polygons += polygon.triangle_count;
      result.polygons.push_back(std::move(polygon));
    }
  }
  result.report.degenerate = object.triangleCount() - in_polygons;
  std::vector<FoundPolygon*> pointers;
  for (FoundPolygon& polygon : result.polygons) {
    pointers.push_back(&polygon);
  }
  occluders::findBodies(scene.positions, pointers, tolerance);
  return result;
}

void add(OccluderReport& sum, const OccluderReport& part) {
  sum.used += part.used;
  sum.see_through += part.see_through;
  sum.marked_never += part.marked_never;
  sum.degenerate += part.degenerate;
  sum.too_small += part.too_small;
}

// The polygons to keep, largest first; the others are counted as too small.
std::vector<RankedPolygon> rank(const SceneView& scene, std::vector<ObjectResult>& results,
                                const OccluderSettings& settings, OccluderReport& report) {
  // Polygons are large: references to them are sorted, and each is moved once.
  struct Candidate {
    FoundPolygon* polygon;
    double area;
    ObjectId object;
    std::uint32_t triangles;
    std::uint32_t body;  // bodies of all objects, numbered one after the other; kNoBody
  };
  LargeVector<Candidate> all;
  double total_area = 0.0;
  std::uint32_t first_body = 0, next_body = 0;
  for (std::size_t o = 0; o < results.size(); ++o, first_body = next_body) {
    for (FoundPolygon& polygon : results[o].polygons) {
      total_area += polygon.area;
      const bool in_body = polygon.body != FoundPolygon::kNoBody;
      const std::uint32_t body = in_body ? first_body + polygon.body : FoundPolygon::kNoBody;
      next_body = in_body ? std::max(next_body, body + 1) : next_body;
      all.push_back({&polygon, polygon.area, ObjectId(o), polygon.triangle_count, body});
    }
    add(report, results[o].report);
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Candidate& a, const Candidate& b) { return a.area > b.area; });
  const std::size_t limit = settings.max_occluders != 0 ? settings.max_occluders : all.size();
  double area_before = 0.0;
  std::vector<RankedPolygon> kept;
  std::vector<bool> body_is_kept(next_body);
  for (const Candidate& candidate : all) {
    const bool in_body = candidate.body != FoundPolygon::kNoBody;
    const bool large =
        area_before < settings.area_fraction * total_area && candidate.area >= settings.min_area;
    const bool marked = scene.objects[candidate.object.value].mark == OccluderMark::kOccluder;
    area_before += candidate.area;
    if ((large || marked || (in_body && body_is_kept[candidate.body])) && kept.size() < limit) {
      if (in_body) {
        body_is_kept[candidate.body] = true;
      }
      kept.push_back({std::move(*candidate.polygon), candidate.object});
    } else {
      report.too_small += candidate.triangles;
    }
  }
  return kept;
}

std::uint32_t clampedVertices(std::uint32_t max_vertices) {
  return std::clamp(max_vertices, 3u, 64u);
}

}  // namespace

OccluderSet findOccluders(const SceneView& scene, const OccluderSettings& settings,
                          const ParallelFor& parallel_for) {
  std::vector<ObjectResult> results(scene.objects.size());
  const std::uint32_t max_vertices = clampedVertices(settings.max_vertices);
  parallel_for(static_cast<std::uint32_t>(results.size()), [&](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t o = begin; o < end; ++o) {
      results[o] = findInObject(scene, scene.objects[o], max_vertices);
    }
  });
  OccluderSet set;
  const std::vector<RankedPolygon> ranked = rank(scene, results, settings, set.report);
  results = {};
  for (std::size_t o = 0; o < scene.objects.size(); ++o) {
    set.objects.push_back(ObjectId(o));
  }
  occluders::assembleSet(scene.positions, ranked, set);
  return set;
}

OccluderSet makeOccluders(std::span<const OccluderPolygon> polygons) {
  // Equal corners get one vertex id, as in a welded mesh.
  Scene corners;
  for (const OccluderPolygon& polygon : polygons) {
    for (const Vec3f& vertex : polygon.vertices) {
      corners.indices.push_back(static_cast<std::uint32_t>(corners.positions.size()));
      corners.positions.push_back(vertex);
    }
  }
  weldPositions(corners);

  std::vector<RankedPolygon> ranked;
  OccluderSet set;
  std::size_t first = 0;
  double largest_of_all = 0.0;
  for (const OccluderPolygon& polygon : polygons) {
    FoundPolygon found;
    found.double_sided = polygon.double_sided;
    double largest = 0.0;
    Vec3d normal;
    for (std::size_t i = 0; i < polygon.vertices.size(); ++i) {
      found.loop.push_back(corners.indices[first + i]);
      largest = std::max(largest, static_cast<double>(maxComponent(abs(polygon.vertices[i]))));
      const Vec3d origin(polygon.vertices[0]);
      normal += cross(Vec3d(polygon.vertices[i]) - origin,
                      Vec3d(polygon.vertices[(i + 1) % polygon.vertices.size()]) - origin);
    }
    first += polygon.vertices.size();
    if (found.loop.size() < 3 || !std::isfinite(largest) || !(length(normal) > 0.0)) {
      ++set.report.degenerate;
      continue;
    }
    found.plane.normal = normalized(normal);
    found.plane.offset = -dot(found.plane.normal, Vec3d(polygon.vertices[0]));
    for (const Vec3f& vertex : polygon.vertices) {
      found.slack = std::max(found.slack, std::abs(found.plane.evaluate(Vec3d(vertex))));
    }
    found.triangle_count = static_cast<std::uint32_t>(found.loop.size() - 2);
    const double tolerance = occluders::roundingTolerance(largest);
    if (found.slack > tolerance || !occluders::finishPolygon(corners.positions, tolerance, 64, found)) {
      ++set.report.degenerate;
      continue;
    }
    largest_of_all = std::max(largest_of_all, largest);
    ranked.push_back({std::move(found), polygon.object});
  }
  std::stable_sort(ranked.begin(), ranked.end(), [](const RankedPolygon& a, const RankedPolygon& b) {
    return a.polygon.area > b.polygon.area;
  });
  std::map<std::uint32_t, std::vector<FoundPolygon*>> by_object;
  for (RankedPolygon& polygon : ranked) {
    by_object[polygon.object.value].push_back(&polygon.polygon);
  }
  for (const auto& [object, of_object] : by_object) {
    if (ObjectId(object).valid()) {
      set.objects.push_back(ObjectId(object));
    }
    occluders::findBodies(corners.positions, of_object, occluders::roundingTolerance(largest_of_all));
  }
  occluders::assembleSet(corners.positions, ranked, set);
  return set;
}

}  // namespace sightline
