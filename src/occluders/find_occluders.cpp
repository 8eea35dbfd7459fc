#include <hwy/cache_control.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "sightline/base/large_vector.h"
#include "sightline/occluders/occluder_set.h"
#include "src/base/parts.h"
#include "src/base/scratch_array.h"
#include "src/base/sort_keys.h"
#include "src/occluders/assemble_set.h"
#include "src/occluders/bodies.h"
#include "src/occluders/divide_outlines.h"
#include "src/occluders/occluder_limits.h"
#include "src/occluders/polygon_merge.h"

namespace sightline {
namespace {

using occluders::FoundPolygon;
using occluders::RankedPolygon;

constexpr std::size_t kTrianglesOfPart = 8192;

// What was found in some objects.
struct PartResult {
  std::vector<FoundPolygon> polygons;       // by object
  std::vector<std::uint32_t> polygon_ends;  // by object
  occluders::IdStore ids;                   // of the polygons
  OccluderReport report;
};

// Finds polygons in one object after the other.
class ObjectSearch {
 public:
  ObjectSearch(const SceneView& scene, std::uint32_t max_vertices, PartResult& result)
      : scene_(scene), result_(result), merger_(scene.positions, max_vertices), bodies_(scene.positions) {}

  void search(const Object& object) {
    const std::size_t first = result_.polygons.size();
    component_of_.clear();
    searchTriangles(object);
    result_.polygon_ends.push_back(static_cast<std::uint32_t>(result_.polygons.size()));
    findBodies(std::span(result_.polygons).subspan(first));
  }

 private:
  void searchTriangles(const Object& object) {
    const Material& material = scene_.materialOf(object);
    const double largest = maxComponent(max(abs(Vec3d(object.bounds.min)), abs(Vec3d(object.bounds.max))));
    if (!material.opaque()) {
      result_.report.see_through += object.triangleCount();
    } else if (object.mark == OccluderMark::kNever) {
      result_.report.marked_never += object.triangleCount();
    } else if (!std::isfinite(largest)) {
      result_.report.degenerate += object.triangleCount();
    } else {
      tolerance_ = occluders::roundingTolerance(largest);
      std::uint64_t in_polygons = 0;
      patches_.find(scene_.positions, scene_.indicesOf(object), material.double_sided, tolerance_);
      for (const occluders::Patch& patch : patches_.patches()) {
        const std::size_t first = result_.polygons.size();
        merger_.merge(patch, patches_.trianglesOf(patch), tolerance_, result_.polygons, result_.ids);
        for (FoundPolygon& polygon : std::span(result_.polygons).subspan(first)) {
          component_of_.push_back(patch.component);
          polygon.double_sided = material.double_sided;
          in_polygons += polygon.triangle_count;
        }
      }
      result_.report.degenerate += object.triangleCount() - in_polygons;
    }
  }

  // A body has all polygons beyond its edges, and so all or none of a component. Most polygons of large
  // meshes are in components of more polygons than any body has, and are left out: so a small solid is a body
  // also where it stands on an edge of such a mesh.
  void findBodies(std::span<FoundPolygon> polygons) {
    polygons_of_component_.clear();
    for (const std::uint32_t component : component_of_) {
      if (component >= polygons_of_component_.size()) {
        polygons_of_component_.resize(component + std::size_t{1});
      }
      ++polygons_of_component_[component];
    }
    pointers_.clear();
    for (std::size_t i = 0; i < polygons.size(); ++i) {
      if (polygons_of_component_[component_of_[i]] <= occluders::kMaxBodyFaces) {
        pointers_.push_back(&polygons[i]);
      }
    }
    bodies_.find(pointers_, tolerance_);
  }

  const SceneView& scene_;
  PartResult& result_;
  occluders::PatchFinder patches_;
  occluders::PolygonMerger merger_;
  occluders::BodyFinder bodies_;
  double tolerance_ = 0.0;
  std::vector<std::uint32_t> component_of_;           // by polygon of the object
  std::vector<std::uint32_t> polygons_of_component_;  // how many
  std::vector<FoundPolygon*> pointers_;
};

void add(OccluderReport& sum, const OccluderReport& part) {
  sum.used += part.used;
  sum.see_through += part.see_through;
  sum.marked_never += part.marked_never;
  sum.degenerate += part.degenerate;
  sum.too_small += part.too_small;
}

// Parts of about as many triangles: the first object of each, and one more.
std::vector<std::uint32_t> partsOf(std::span<const Object> objects) {
  std::vector<std::uint32_t> first(1, 0);
  std::size_t triangles = 0;
  for (std::uint32_t o = 0; o < objects.size(); ++o) {
    triangles += objects[o].triangleCount();
    if (triangles >= kTrianglesOfPart || o + 1 == objects.size()) {
      first.push_back(o + 1);
      triangles = 0;
    }
  }
  return first;
}

// Polygons of all objects, by object.
struct AllPolygons {
  LargeVector<RankedPolygon> polygons;  // without ids
  LargeVector<std::uint32_t> body_of;   // by polygon: bodies of all objects, one after the other; kNoBody
  std::uint32_t body_count = 0;
};

AllPolygons listAll(std::span<PartResult> parts) {
  AllPolygons all;
  const std::size_t count =
      std::accumulate(parts.begin(), parts.end(), std::size_t{0},
                      [](std::size_t sum, const PartResult& part) { return sum + part.polygons.size(); });
  all.polygons.reserve(count);
  all.body_of.reserve(count);
  std::uint32_t object = 0;
  for (PartResult& part : parts) {
    std::uint32_t first = 0;
    for (const std::uint32_t end : part.polygon_ends) {
      const std::uint32_t first_body = all.body_count;
      for (const FoundPolygon& polygon : std::span(part.polygons).subspan(first, end - first)) {
        const bool in_body = polygon.body != FoundPolygon::kNoBody;
        all.polygons.push_back({&polygon, ObjectId(object), OccluderId()});
        all.body_of.push_back(in_body ? first_body + polygon.body : FoundPolygon::kNoBody);
        all.body_count = in_body ? std::max(all.body_count, all.body_of.back() + 1) : all.body_count;
      }
      first = end;
      ++object;
    }
  }
  return all;
}

// Gives ids to the polygons to keep, the largest first, and removes the others, which count as too small.
void rank(const SceneView& scene, const OccluderSettings& settings, const ParallelFor& parallel_for,
          AllPolygons& all, OccluderReport& report) {
  LargeVector<base::SortKey> by_area;
  by_area.reserve(all.polygons.size());
  double total_area = 0.0;
  for (std::size_t i = 0; i < all.polygons.size(); ++i) {
    const double area = all.polygons[i].polygon->area;
    total_area += area;
    by_area.push_back({base::descending(area), i});
  }
  base::KeySorter().sort(by_area, parallel_for);
  const std::size_t limit = settings.max_occluders != 0 ? settings.max_occluders : all.polygons.size();
  double area_before = 0.0;
  std::uint32_t next = 0;
  std::vector<bool> body_is_kept(all.body_count);
  for (std::size_t rank = 0; rank < by_area.size(); ++rank) {
    // What is next by area lies anywhere in memory, so it is asked for early.
    constexpr std::size_t kAhead = 16;
    if (rank + kAhead < by_area.size()) {
      hwy::Prefetch(&all.polygons[by_area[rank + kAhead].second]);
      hwy::Prefetch(&all.body_of[by_area[rank + kAhead].second]);
    }
    const base::SortKey& key = by_area[rank];
    const double area = base::valueOf(key.first);
    RankedPolygon& polygon = all.polygons[key.second];
    const std::uint32_t body = all.body_of[key.second];
    const bool in_body = body != FoundPolygon::kNoBody;
    const bool large = area_before < settings.area_fraction * total_area && area >= settings.min_area;
    area_before += area;
    if ((large || scene.objects[polygon.object.value].mark == OccluderMark::kOccluder ||
         (in_body && body_is_kept[body])) &&
        next < limit) {
      if (in_body) {
        body_is_kept[body] = true;
      }
      polygon.id = OccluderId(next++);
    }
  }
  std::erase_if(all.polygons, [&](const RankedPolygon& polygon) {
    (polygon.id.valid() ? report.used : report.too_small) += polygon.polygon->triangle_count;
    return !polygon.id.valid();
  });
}

std::uint32_t clampedVertices(std::uint32_t max_vertices) {
  return std::clamp(max_vertices, 3u, 64u);
}

}  // namespace

OccluderSet findOccluders(const SceneView& scene, const OccluderSettings& settings,
                          const ParallelFor& parallel_for) {
  const std::uint32_t max_vertices = clampedVertices(settings.max_vertices);
  const std::vector<std::uint32_t> first_of_part = partsOf(scene.objects);
  std::vector<PartResult> parts(first_of_part.size() - 1);
  base::forEach(parallel_for, parts.size(), [&](std::uint32_t part) {
    std::size_t triangles = 0;
    for (std::uint32_t o = first_of_part[part]; o < first_of_part[part + 1]; ++o) {
      triangles += scene.objects[o].triangleCount();
    }
    parts[part].polygons.reserve(std::min(triangles, 2 * kTrianglesOfPart));
    ObjectSearch search(scene, max_vertices, parts[part]);
    for (std::uint32_t o = first_of_part[part]; o < first_of_part[part + 1]; ++o) {
      search.search(scene.objects[o]);
    }
  });
  OccluderSet set;
  for (const PartResult& part : parts) {
    add(set.report, part.report);
  }
  AllPolygons all = listAll(parts);
  rank(scene, settings, parallel_for, all, set.report);
  base::freeVector(all.body_of);
  set.objects.resize(scene.objects.size());
  for (std::size_t o = 0; o < scene.objects.size(); ++o) {
    set.objects[o] = ObjectId(o);
  }
  occluders::DividedOutlines divided;
  occluders::divideOutlines(scene.positions, parallel_for, all.polygons, divided);
  occluders::assembleSet(scene.positions, all.polygons, parallel_for, set);
  return set;
}

}  // namespace sightline
