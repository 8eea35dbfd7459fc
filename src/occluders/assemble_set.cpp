#include "src/occluders/assemble_set.h"

#include <hwy/cache_control.h>

#include <algorithm>
#include <new>
#include <utility>

#include "src/base/parallel_rows.h"
#include "src/base/scratch_array.h"
#include "src/occluders/bodies.h"
#include "src/occluders/links.h"

namespace sightline::occluders {
namespace {

// False where a corner is sharper than three degrees: near it, a neighbour's own boundary would be too close
// to the shared edge.
bool hasNoSharpCorner(std::span<const Vec3f> corners) {
  constexpr double kSine = 0.052;
  Vec3d before = Vec3d(corners.front()) - Vec3d(corners.back());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3f& next = corners[i + 1 < corners.size() ? i + 1 : 0];
    const Vec3d after = Vec3d(next) - Vec3d(corners[i]), across = cross(before, after);
    if (dot(before, after) < 0.0 &&
        dot(across, across) < kSine * kSine * dot(before, before) * dot(after, after)) {
      return false;
    }
    before = after;
  }
  return true;
}

// memory: what it holds before does not matter.
void writeOccluder(const RankedPolygon& ranked, std::uint32_t first_vertex, std::span<const Vec3f> corners,
                   Occluder* memory) {
  const FoundPolygon& polygon = *ranked.polygon;
  Occluder& occluder = *::new (memory) Occluder();
  occluder.first_vertex = first_vertex;
  occluder.vertex_count = static_cast<std::uint16_t>(corners.size());
  occluder.double_sided = polygon.double_sided;
  occluder.watertight_edges = hasNoSharpCorner(corners);
  occluder.object = ranked.object;
  occluder.area = static_cast<float>(polygon.area);
  occluder.slack = polygon.slack;
  occluder.plane = polygon.plane;
  occluder.centroid = polygon.centroid;
}

// Writes the occluders with their corners. Returns the first vertices by place.
LargeVector<std::uint32_t> writeOccluders(std::span<const Vec3f> positions,
                                          std::span<const RankedPolygon> polygons,
                                          const ParallelFor& parallel_for, OccluderSet& set) {
  // Neighbouring polygons are written far apart, so the memory of a later one is asked for while one is made.
  constexpr std::uint32_t kAhead = 8;
  struct Size {
    double area;
    std::uint32_t vertices;  // then the first one
  };
  LargeVector<Size> sizes = base::unsetVector<Size>(polygons.size());  // by id
  base::forEach(parallel_for, polygons.size(), [&](std::uint32_t i) {
    const FoundPolygon& polygon = *polygons[i].polygon;
    sizes[polygons[i].id.value] = {polygon.area, static_cast<std::uint32_t>(polygon.corners().size())};
  });
  std::uint32_t vertices = 0;
  for (Size& size : sizes) {
    vertices += std::exchange(size.vertices, vertices);
    set.area += size.area;
  }
  LargeVector<std::uint32_t> by_place = base::unsetVector<std::uint32_t>(polygons.size());
  base::forEach(parallel_for, polygons.size(),
                [&](std::uint32_t i) { by_place[i] = sizes[polygons[i].id.value].vertices; });
  set.occluders = base::unsetVector<Occluder>(polygons.size());
  set.vertices = base::unsetVector<Vec3f>(vertices);
  parallel_for(static_cast<std::uint32_t>(polygons.size()), [&](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t i = begin; i < end; ++i) {
      if (i + kAhead < end) {
        hwy::Prefetch(&set.occluders[polygons[i + kAhead].id.value]);
        hwy::Prefetch(set.vertices.data() + by_place[i + kAhead]);
      }
      const FoundPolygon& polygon = *polygons[i].polygon;
      const std::span<Vec3f> corners = std::span(set.vertices).subspan(by_place[i], polygon.corners().size());
      for (std::size_t k = 0; k < corners.size(); ++k) {
        corners[k] = positions[polygon.loop()[polygon.corners()[k]]];
      }
      writeOccluder(polygons[i], by_place[i], corners, &set.occluders[polygons[i].id.value]);
    }
  });
  return by_place;
}

// Lists, for each object, the occluders for which listed(id) is true, in the order of their ids.
template <typename Listed>
void listByObject(const OccluderSet& set, const ParallelFor& parallel_for, const Listed& listed,
                  LargeVector<std::uint32_t>& first, LargeVector<OccluderId>& ids) {
  base::groupIntoRows(parallel_for, set.objects.size(), set.occluders.size(), first, ids,
                      [&](std::size_t begin, std::size_t end, auto&& pair) {
                        for (std::size_t i = begin; i < end; ++i) {
                          const std::size_t place = set.placeOf(set.occluders[i].object);
                          const auto id = OccluderId(i);
                          if (place < set.objects.size() && listed(id)) {
                            pair(place, id);
                          }
                        }
                      });
}

}  // namespace

void assembleSet(std::span<const Vec3f> positions, std::span<const RankedPolygon> polygons,
                 const ParallelFor& parallel_for, OccluderSet& set) {
  LargeVector<std::uint32_t> first_vertex = writeOccluders(positions, polygons, parallel_for, set);
  linkEdges(positions, polygons, std::move(first_vertex), parallel_for, set);
  assembleBodies(positions, polygons, parallel_for, set);
  listByObject(
      set, parallel_for, [](OccluderId) { return true; }, set.first_of_object, set.of_object);
  const auto stands_for_all = [&](OccluderId id) {
    const OccluderBody* body = set.bodyOf(id);
    return body == nullptr || set.facesOf(*body).front().occluder == id;
  };
  listByObject(set, parallel_for, stands_for_all, set.first_unit_of_object, set.unit_of_object);
}

}  // namespace sightline::occluders
