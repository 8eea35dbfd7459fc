#include "src/occluders/assemble_set.h"

#include "src/base/parallel_rows.h"
#include "src/occluders/bodies.h"
#include "src/occluders/links.h"

namespace sightline::occluders {
namespace {

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
  linkPolygons(positions, polygons, parallel_for, set);
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
