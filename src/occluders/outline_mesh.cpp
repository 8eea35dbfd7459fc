#include "src/occluders/outline_mesh.h"

#include <numeric>
#include <utility>
#include <vector>

#include "src/base/parallel_rows.h"
#include "src/base/scratch_array.h"

namespace sightline::occluders {
namespace {

constexpr std::size_t kLowVerticesOfPart = 16384;

}  // namespace

OutlineMesh::OutlineMesh(std::span<const Vec3f> positions, std::span<const RankedPolygon> polygons,
                         const ParallelFor& parallel_for)
    : positions_(positions), polygons_(polygons) {
  number(parallel_for);
  findBeyond(usesByVertex(parallel_for), parallel_for);
}

void OutlineMesh::number(const ParallelFor& parallel_for) {
  first_edge_ = base::unsetVector<std::uint32_t>(polygons_.size() + 1);
  first_use_ = base::unsetVector<std::uint32_t>(polygons_.size() + 1);
  first_edge_[0] = first_use_[0] = 0;
  const base::Parts parts(polygons_.size(), kPolygonsOfPart);
  parts.run(parallel_for, [this](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const FoundPolygon& polygon = *polygons_[i].polygon;
      first_edge_[i + 1] = static_cast<std::uint32_t>(polygon.corners().size());
      first_use_[i + 1] = static_cast<std::uint32_t>(polygon.loop().size());
    }
  });
  std::partial_sum(first_edge_.begin(), first_edge_.end(), first_edge_.begin());
  std::partial_sum(first_use_.begin(), first_use_.end(), first_use_.begin());
  place_of_edge_ = base::unsetVector<std::uint32_t>(first_edge_.back());
  kind_ = base::unsetVector<Kind>(first_edge_.back());
  const bool all_one = useCount() == edgeCount();
  edge_of_use_ = base::unsetVector<std::uint32_t>(all_one ? 0 : useCount());
  parts.run(parallel_for, [this, all_one](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (all_one) {
        std::fill_n(place_of_edge_.begin() + first_edge_[i], first_edge_[i + 1] - first_edge_[i],
                    static_cast<std::uint32_t>(i));
        std::fill_n(kind_.begin() + first_edge_[i], first_edge_[i + 1] - first_edge_[i], Kind::kOne);
        continue;
      }
      const FoundPolygon& polygon = *polygons_[i].polygon;
      std::uint32_t use = first_use_[i];
      for (std::uint32_t edge = first_edge_[i]; edge < first_edge_[i + 1]; ++edge) {
        place_of_edge_[edge] = static_cast<std::uint32_t>(i);
        const std::uint32_t count = meshEdgesFrom(polygon, edge - first_edge_[i]);
        kind_[edge] = count == 1 ? Kind::kOne : Kind::kSeveral;
        std::fill_n(edge_of_use_.begin() + use, count, edge);
        use += count;
      }
    }
  });
}

// By the mesh edge's lower vertex.
base::Rows<OutlineMesh::Use> OutlineMesh::usesByVertex(const ParallelFor& parallel_for) const {
  base::Rows<Use> by_vertex;
  base::groupIntoRows(parallel_for, positions_.size(), polygons_.size(), by_vertex.first(), by_vertex.all(),
                      [this](std::size_t begin, std::size_t end, auto&& pair) {
                        for (std::size_t i = begin; i < end; ++i) {
                          const std::span<const std::uint32_t> loop = polygons_[i].polygon->loop();
                          std::size_t at = polygons_[i].polygon->corners()[0];
                          std::uint32_t from = loop[at];
                          for (std::uint32_t use = first_use_[i]; use < first_use_[i + 1]; ++use) {
                            at = at + 1 < loop.size() ? at + 1 : 0;
                            const std::uint32_t to = loop[at];
                            pair(std::min(from, to), Use{std::max(from, to), use});
                            from = to;
                          }
                        }
                      });
  return by_vertex;
}

// Whether an edge comes before another one in a set, which has the largest polygons first.
bool OutlineMesh::isBefore(std::uint32_t a, std::uint32_t b) const {
  const OccluderId of_a = polygons_[placeOf(a)].id, of_b = polygons_[placeOf(b)].id;
  return of_a != of_b ? of_a < of_b : a < b;
}

// users: all uses of a mesh edge. An edge that is one mesh edge has no other users, so no other thread looks
// at it.
void OutlineMesh::join(std::span<const Use> users, base::Rows<std::uint32_t>& crowded) {
  if (users.size() == 1) {
    beyond_[users[0].use] = kNone;
  } else if (users.size() == 2) {
    beyond_[users[0].use] = users[1].use;
    beyond_[users[1].use] = users[0].use;
  } else {
    for (const Use& user : users) {
      crowded.add(user.use);
    }
    crowded.endRow();
  }
  std::uint32_t first = edgeOf(users[0].use);
  bool all_one = kind_[first] == Kind::kOne;
  for (const Use& user : users.subspan(1)) {
    const std::uint32_t edge = edgeOf(user.use);
    all_one = all_one && kind_[edge] == Kind::kOne;
    first = all_one && isBefore(edge, first) ? edge : first;
  }
  if (all_one) {
    kind_[first] = Kind::kFirst;
    return;
  }
  for (const Use& user : users) {
    if (kind_[edgeOf(user.use)] == Kind::kOne) {
      kind_[edgeOf(user.use)] = Kind::kSeveral;
    }
  }
}

void OutlineMesh::findBeyond(base::Rows<Use> by_vertex, const ParallelFor& parallel_for) {
  beyond_ = base::unsetVector<std::uint32_t>(useCount());
  const base::Parts parts(by_vertex.count(), kLowVerticesOfPart);
  std::vector<base::Rows<std::uint32_t>> crowded(parts.count());
  parts.run(parallel_for, [&](std::size_t part, std::size_t begin, std::size_t end) {
    for (std::size_t low = begin; low < end; ++low) {
      const std::span<Use> uses = by_vertex[low];
      std::sort(uses.begin(), uses.end());
      for (std::size_t i = 0, next = 0; i < uses.size(); i = next) {
        while (next < uses.size() && uses[next].high == uses[i].high) {
          ++next;
        }
        join(uses.subspan(i, next - i), crowded[part]);
      }
    }
  });
  for (const base::Rows<std::uint32_t>& of_part : crowded) {
    for (std::size_t row = 0; row < of_part.count(); ++row) {
      for (const std::uint32_t use : of_part[row]) {
        beyond_[use] = kCrowded + static_cast<std::uint32_t>(crowded_.count());
        crowded_.add(use);
      }
      crowded_.endRow();
    }
  }
}

}  // namespace sightline::occluders
