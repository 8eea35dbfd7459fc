#include "src/occluders/assemble_set.h"

#include <algorithm>
#include <utility>

#include "src/base/parallel_rows.h"
#include "src/occluders/bodies.h"
#include "src/occluders/links.h"

namespace sightline::occluders {
namespace {

// False where a corner is sharper than three degrees: near it, a neighbour's own boundary would be too close
// to the shared edge.
bool hasNoSharpCorner(std::span<const Vec3f> corners) {
  constexpr double kSine = 0.052;
  Vec3d before = normalized(Vec3d(corners.front()) - Vec3d(corners.back()));
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3f& next = corners[i + 1 < corners.size() ? i + 1 : 0];
    const Vec3d after = normalized(Vec3d(next) - Vec3d(corners[i]));
    if (dot(before, after) < 0.0 && length(cross(before, after)) < kSine) {
      return false;
    }
    before = after;
  }
  return true;
}

// Writes the occluders with their corners. Returns the first vertices by place.
LargeVector<std::uint32_t> writeOccluders(std::span<const Vec3f> positions,
                                          std::span<const RankedPolygon> polygons,
                                          const ParallelFor& parallel_for, OccluderSet& set) {
  LargeVector<std::uint32_t> first_vertex(polygons.size());  // by id
  LargeVector<double> areas(polygons.size());                // by id
  base::forEach(parallel_for, polygons.size(), [&](std::uint32_t i) {
    const auto [polygon, object, id] = polygons[i];
    first_vertex[id.value] = static_cast<std::uint32_t>(polygon->corners.size());
    areas[id.value] = polygon->area;
  });
  std::uint32_t size = 0;
  for (std::size_t id = 0; id < polygons.size(); ++id) {
    size += std::exchange(first_vertex[id], size);
    set.area += areas[id];
  }
  set.occluders.resize(polygons.size());
  set.vertices.resize(size);
  LargeVector<std::uint32_t> by_place(polygons.size());
  base::forEach(parallel_for, polygons.size(), [&](std::uint32_t i) {
    const auto [polygon, object, id] = polygons[i];
    by_place[i] = first_vertex[id.value];
    const std::span<Vec3f> corners = std::span(set.vertices).subspan(by_place[i], polygon->corners.size());
    for (std::size_t k = 0; k < corners.size(); ++k) {
      corners[k] = positions[polygon->loop[polygon->corners[k]]];
    }
    Occluder& occluder = set.occluders[id.value];
    occluder.first_vertex = by_place[i];
    occluder.vertex_count = static_cast<std::uint16_t>(corners.size());
    occluder.double_sided = polygon->double_sided;
    occluder.watertight_edges = hasNoSharpCorner(corners);
    occluder.object = object;
    occluder.area = static_cast<float>(polygon->area);
    occluder.slack = static_cast<float>(polygon->slack * 1.001);
    occluder.plane = polygon->plane;
    occluder.centroid = Vec3f(polygon->centroid);
  });
  return by_place;
}

// Lists, for each object, the occluders for which listed(id) is true, in the order of their ids.
template <typename Listed>
void listByObject(const OccluderSet& set, std::span<const RankedPolygon> polygons,
                  const ParallelFor& parallel_for, const Listed& listed, LargeVector<std::uint32_t>& first,
                  LargeVector<OccluderId>& ids) {
  base::groupIntoRows(parallel_for, set.objects.size(), polygons.size(), first, ids,
                      [&](std::size_t begin, std::size_t end, auto&& pair) {
                        for (std::size_t i = begin; i < end; ++i) {
                          const std::size_t place = set.placeOf(polygons[i].object);
                          if (place < set.objects.size() && listed(polygons[i].id)) {
                            pair(place, polygons[i].id);
                          }
                        }
                      });
  base::forEach(parallel_for, set.objects.size(), [&](std::uint32_t object) {
    std::sort(ids.begin() + first[object], ids.begin() + first[object + 1]);
  });
}

}  // namespace

void assembleSet(std::span<const Vec3f> positions, std::span<const RankedPolygon> polygons,
                 const ParallelFor& parallel_for, OccluderSet& set) {
  LargeVector<std::uint32_t> first_vertex = writeOccluders(positions, polygons, parallel_for, set);
  linkEdges(positions, polygons, std::move(first_vertex), parallel_for, set);
  assembleBodies(positions, polygons, parallel_for, set);
  listByObject(
      set, polygons, parallel_for, [](OccluderId) { return true; }, set.first_of_object, set.of_object);
  const auto stands_for_all = [&](OccluderId id) {
    const OccluderBody* body = set.bodyOf(id);
    return body == nullptr || set.facesOf(*body).front().occluder == id;
  };
  listByObject(set, polygons, parallel_for, stands_for_all, set.first_unit_of_object, set.unit_of_object);
}

}  // namespace sightline::occluders
