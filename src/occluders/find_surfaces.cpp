// Connected clusters of all opaque triangles of a scene, and their boundaries.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "sightline/occluders/surface_set.h"
#include "src/occluders/surface_chains.h"
#include "src/occluders/surface_mesh.h"

namespace sightline {
namespace {

using occluders::MeshTriangle;
using occluders::SurfaceMesh;

constexpr std::uint32_t kUngathered = 0xffffffffu;
constexpr double kRounding = 1e-6;  // far above that of cosines, and of a plane through single precision

LargeVector<Vec3d> unitNormals(const SurfaceMesh& mesh) {
  LargeVector<Vec3d> normals;
  normals.reserve(mesh.triangles.size());
  for (const MeshTriangle& t : mesh.triangles) {
    const Vec3d a(mesh.vertices[t.vertices[0]]);
    const Vec3d normal =
        cross(Vec3d(mesh.vertices[t.vertices[1]]) - a, Vec3d(mesh.vertices[t.vertices[2]]) - a);
    const double size = length(normal);
    normals.push_back(size > 0.0 ? normal / size : Vec3d{});
  }
  return normals;
}

// Gathers triangles of the same sidedness, and of the same part of an earlier gathering, from a
// first one on over its edges, one part after the other.
class Gathering {
 public:
  Gathering(const SurfaceMesh& mesh, std::span<const Vec3d> normals, std::uint32_t max_triangles,
            double max_angle_deg, std::span<const std::uint32_t> within)
      : mesh_(mesh),
        normals_(normals),
        within_(within),
        max_triangles_(std::clamp(max_triangles, 1u, 65535u)),
        min_cosine_(std::cos(std::clamp(max_angle_deg, 0.0, 180.0) * 0.017453292519943295)) {}

  // Triangles by part. order: the first triangles of parts are sought in this order.
  base::Rows<std::uint32_t> gather(std::span<const std::uint32_t> order) {
    base::Rows<std::uint32_t> parts;
    part_of_.assign(mesh_.triangles.size(), kUngathered);
    std::vector<std::uint32_t> members;
    for (const std::uint32_t seed : order) {
      if (part_of_[seed] != kUngathered) {
        continue;
      }
      const auto part = static_cast<std::uint32_t>(parts.count());
      members.assign(1, seed);
      part_of_[seed] = part;
      for (std::size_t next = 0; next < members.size(); ++next) {
        for (const std::uint32_t edge : mesh_.triangles[members[next]].edges) {
          for (const std::uint32_t t : mesh_.beside[edge / 2]) {
            if (members.size() < max_triangles_ && part_of_[t] == kUngathered && belongs(t, seed)) {
              part_of_[t] = part;
              members.push_back(t);
            }
          }
        }
      }
      for (const std::uint32_t t : members) {
        parts.add(t);
      }
      parts.endRow();
    }
    return parts;
  }

  std::span<const std::uint32_t> partOf() const { return part_of_; }  // by triangle

 private:
  // Triangles without area belong to any part.
  bool belongs(std::uint32_t t, std::uint32_t seed) const {
    const MeshTriangle &a = mesh_.triangles[t], &b = mesh_.triangles[seed];
    return (normals_[t] == Vec3d{} || dot(normals_[t], normals_[seed]) >= min_cosine_) &&
           a.double_sided == b.double_sided && (within_.empty() || within_[t] == within_[seed]);
  }

  const SurfaceMesh& mesh_;
  std::span<const Vec3d> normals_;
  std::span<const std::uint32_t> within_;
  std::uint32_t max_triangles_;
  double min_cosine_;
  LargeVector<std::uint32_t> part_of_;
};

// Sets where some triangles lie and which way they face. Part: a SurfaceCluster or a SurfacePatch. Returns
// the cosine of the greatest angle between normals and that of the supporting plane, rounded down.
template <typename Part>
double measure(const SurfaceMesh& mesh, std::span<const Vec3d> normals,
               std::span<const std::uint32_t> triangles, Part& part, Box& bounds) {
  Vec3d axis{};
  for (const std::uint32_t t : triangles) {
    const MeshTriangle& triangle = mesh.triangles[t];
    const Vec3d a(mesh.vertices[triangle.vertices[0]]);
    axis +=
        cross(Vec3d(mesh.vertices[triangle.vertices[1]]) - a, Vec3d(mesh.vertices[triangle.vertices[2]]) - a);
  }
  const double size = length(axis);
  axis = size > 0.0 ? axis / size : Vec3d{0.0, 0.0, 1.0};
  double cosine = 1.0, lowest = std::numeric_limits<double>::infinity(), highest = -lowest, reach = 0.0;
  for (const std::uint32_t t : triangles) {
    cosine = normals[t] == Vec3d{} ? cosine : std::min(cosine, dot(normals[t], axis));
    for (const std::uint32_t v : mesh.triangles[t].vertices) {
      const Vec3d p(mesh.vertices[v]);
      bounds.extend(mesh.vertices[v]);
      lowest = std::min(lowest, dot(axis, p));
      highest = std::max(highest, dot(axis, p));
      reach = std::max(reach, maxComponent(abs(p)));
    }
  }
  part.support = {axis, -(lowest - 1e-14 * reach)};
  part.thickness = highest - lowest + 4e-14 * reach;
  part.double_sided = mesh.triangles[triangles[0]].double_sided;
  return size > 0.0 ? std::max(-1.0, cosine - kRounding) : -1.0;
}

// Lists the clusters that adjoin each part. part_of: by cluster.
void findAdjoining(std::span<const std::uint32_t> part_of, SurfaceSet& set) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;  // part and cluster
  for (const SurfaceChain& chain : set.chains) {
    for (const ChainUse& a : set.usesOf(chain)) {
      for (const ChainUse& b : set.usesOf(chain)) {
        if (part_of[a.cluster] != part_of[b.cluster]) {
          pairs.push_back({part_of[a.cluster], b.cluster});
        }
      }
    }
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  base::groupIntoRows(set.parts.size(), set.first_adjoining, set.adjoining, [&](auto&& add) {
    for (const auto& pair : pairs) {
      add(pair.first, pair.second);
    }
  });
}

// Calls visit(whole, chain, value) for each whole that ends at a chain. whole_of: by cluster.
template <typename Visit>
void visitBoundaries(const SurfaceSet& set, std::span<const std::uint32_t> whole_of, Visit&& visit) {
  for (std::uint32_t chain = 0; chain < set.chains.size(); ++chain) {
    const std::span<const ChainUse> uses = set.usesOf(set.chains[chain]);
    for (std::size_t i = 0; i < uses.size(); ++i) {
      const std::uint32_t whole = whole_of[uses[i].cluster];
      std::int32_t sum = 0;
      bool first = true;
      for (std::size_t k = 0; k < uses.size(); ++k) {
        if (whole_of[uses[k].cluster] == whole) {
          sum += uses[k].value;
          first = first && k >= i;
        }
      }
      if (first && sum != 0) {
        visit(whole, chain, sum);
      }
    }
  }
}

// Lists the boundaries of patches, and counts the edges of those of patches and parts. Both: by cluster.
void findBoundaries(std::span<const std::uint32_t> patch_of, std::span<const std::uint32_t> part_of,
                    SurfaceSet& set) {
  const auto edgesOf = [&](std::uint32_t chain) { return set.chains[chain].vertex_count - 1; };
  visitBoundaries(set, part_of, [&](std::uint32_t part, std::uint32_t chain, std::int32_t) {
    set.parts[part].edge_count += edgesOf(chain);
  });
  visitBoundaries(set, patch_of, [&](std::uint32_t patch, std::uint32_t chain, std::int32_t) {
    set.patches[patch].edge_count += edgesOf(chain);
    ++set.patches[patch].chain_count;
  });
  std::uint32_t size = 0;
  for (SurfacePatch& patch : set.patches) {
    patch.first_chain = size;
    size += std::exchange(patch.chain_count, 0);
  }
  set.patch_chains.resize(size);
  visitBoundaries(set, patch_of, [&](std::uint32_t number, std::uint32_t chain, std::int32_t value) {
    SurfacePatch& patch = set.patches[number];
    set.patch_chains[patch.first_chain + patch.chain_count++] = {chain, value};
  });
}

float diameter(const Box& box) {
  return length(box.extent());
}

// part_of: by triangle of the mesh.
void listByObject(const SurfaceMesh& mesh, std::span<const std::uint32_t> part_of, std::size_t objects,
                  SurfaceSet& set) {
  set.first_of_object.assign(1, 0);
  std::size_t t = 0;
  for (std::uint32_t object = 0; object < objects; ++object) {
    const std::size_t first = set.of_object.size();
    for (; t < mesh.triangles.size() && mesh.triangles[t].object == object; ++t) {
      set.of_object.push_back(part_of[t]);
    }
    const auto begin = set.of_object.begin() + static_cast<std::ptrdiff_t>(first);
    std::sort(begin, set.of_object.end());
    set.of_object.erase(std::unique(begin, set.of_object.end()), set.of_object.end());
    std::stable_sort(begin, set.of_object.end(), [&](std::uint32_t a, std::uint32_t b) {
      return diameter(set.part_bounds[a]) > diameter(set.part_bounds[b]);
    });
    if (set.of_object.size() > first) {
      set.objects.push_back(ObjectId(object));
    }
    Box bounds;
    for (std::size_t i = first; i < set.of_object.size(); ++i) {
      bounds.extend(set.part_bounds[set.of_object[i]]);
      set.sizes_of_object.push_back(diameter(set.part_bounds[set.of_object[i]]));
    }
    set.object_bounds.push_back(bounds);
    set.first_of_object.push_back(static_cast<std::uint32_t>(set.of_object.size()));
  }
}

}  // namespace

SurfaceSet findSurfaces(const SceneView& scene, const SurfaceSettings& settings,
                        const ParallelFor& parallel_for) {
  SurfaceSet set;
  SurfaceMesh mesh = occluders::weld(scene);
  if (settings.join_edges) {
    occluders::divideEdges(mesh, parallel_for);
  }
  const LargeVector<Vec3d> normals = unitNormals(mesh);
  LargeVector<std::uint32_t> order(mesh.triangles.size());
  std::iota(order.begin(), order.end(), 0u);
  Gathering parts(mesh, normals, settings.part_triangles, 180.0, {});
  const base::Rows<std::uint32_t> by_part = parts.gather(order);
  Gathering patches(mesh, normals, settings.patch_triangles, settings.max_angle_deg, parts.partOf());
  const base::Rows<std::uint32_t> by_patch = patches.gather(by_part.items());
  Gathering clusters(mesh, normals, settings.cluster_triangles, settings.max_angle_deg, patches.partOf());
  const base::Rows<std::uint32_t> by_cluster = clusters.gather(by_patch.items());

  set.parts.resize(by_part.count());
  set.patches.resize(by_patch.count());
  set.clusters.resize(by_cluster.count());
  set.part_bounds.resize(by_part.count());
  set.patch_bounds.resize(by_patch.count());
  set.cluster_bounds.resize(by_cluster.count());
  const auto count = [](std::uint32_t i, std::uint32_t& first, std::uint32_t& number) {
    first = number == 0 ? i : first;
    ++number;
  };
  for (std::uint32_t p = 0; p < by_patch.count(); ++p) {
    SurfacePart& part = set.parts[parts.partOf()[by_patch[p][0]]];
    count(p, part.first_patch, part.patch_count);
  }
  for (std::uint32_t c = 0, triangle = 0; c < by_cluster.count(); ++c) {
    SurfacePatch& patch = set.patches[patches.partOf()[by_cluster[c][0]]];
    count(c, patch.first_cluster, patch.cluster_count);
    set.clusters[c].first_triangle = triangle;
    set.clusters[c].triangle_count = static_cast<std::uint32_t>(by_cluster[c].size());
    triangle += set.clusters[c].triangle_count;
  }
  const auto parallel = [&](std::size_t size, auto&& one) {
    parallel_for(static_cast<std::uint32_t>(size), [&](std::uint32_t begin, std::uint32_t end) {
      for (std::uint32_t i = begin; i < end; ++i) {
        one(i);
      }
    });
  };
  parallel(by_cluster.count(), [&](std::uint32_t c) {
    measure(mesh, normals, by_cluster[c], set.clusters[c], set.cluster_bounds[c]);
  });
  parallel(by_patch.count(), [&](std::uint32_t p) {
    const double cosine = measure(mesh, normals, by_patch[p], set.patches[p], set.patch_bounds[p]);
    set.patches[p].cone_cosine = static_cast<float>(cosine - kRounding);
  });
  for (std::size_t p = 0; p < set.parts.size(); ++p) {
    const SurfacePart& part = set.parts[p];
    for (std::uint32_t i = part.first_patch; i < part.first_patch + part.patch_count; ++i) {
      set.part_bounds[p].extend(set.patch_bounds[i]);
    }
    set.bounds.extend(set.part_bounds[p]);
  }
  set.triangles.reserve(3 * mesh.triangles.size());
  for (const std::uint32_t t : by_cluster.items()) {
    set.triangles.insert(set.triangles.end(), mesh.triangles[t].vertices, mesh.triangles[t].vertices + 3);
  }
  listByObject(mesh, parts.partOf(), scene.objects.size(), set);
  set.vertices = std::move(mesh.vertices);
  occluders::findChains(mesh, clusters.partOf(), set);
  LargeVector<std::uint32_t> part_of(set.clusters.size()), patch_of(set.clusters.size());
  for (std::size_t c = 0; c < by_cluster.count(); ++c) {
    part_of[c] = parts.partOf()[by_cluster[c][0]];
    patch_of[c] = patches.partOf()[by_cluster[c][0]];
  }
  findAdjoining(part_of, set);
  findBoundaries(patch_of, part_of, set);
  return set;
}

}  // namespace sightline
