// Connected clusters of all opaque triangles of a scene, and their boundaries.

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "sightline/occluders/surface_set.h"
#include "src/base/parallel_rows.h"
#include "src/base/scratch_array.h"
#include "src/occluders/surfaces/surface_chains.h"
#include "src/occluders/surfaces/surface_gather.h"
#include "src/occluders/surfaces/surface_mesh.h"

namespace sightline {
namespace {

// Sorts each row and leaves out what it has several times.
void makeUnique(const ParallelFor& parallel_for, base::Rows<std::uint32_t>& rows,
                LargeVector<std::uint32_t>& first, LargeVector<std::uint32_t>& items) {
  first.assign(rows.count() + 1, 0);
  base::forEach(parallel_for, rows.count(), [&](std::uint32_t r) {
    const std::span<std::uint32_t> row = rows[r];
    std::sort(row.begin(), row.end());
    first[r + 1] = static_cast<std::uint32_t>(std::unique(row.begin(), row.end()) - row.begin());
  });
  std::partial_sum(first.begin(), first.end(), first.begin());
  items.resize(first.back());
  base::forEach(parallel_for, rows.count(), [&](std::uint32_t r) {
    std::copy_n(rows[r].begin(), first[r + 1] - first[r], items.begin() + first[r]);
  });
}

// Calls visit(whole, its uses) for each whole with clusters that end at a chain. whole_of: by cluster,
// ascending, as the uses are.
template <typename Visit>
void forEachWhole(std::span<const ChainUse> uses, std::span<const std::uint32_t> whole_of, Visit&& visit) {
  for (std::size_t i = 0, end = 0; i < uses.size(); i = end) {
    const std::uint32_t whole = whole_of[uses[i].cluster];
    while (end < uses.size() && whole_of[uses[end].cluster] == whole) {
      ++end;
    }
    visit(whole, uses.subspan(i, end - i));
  }
}

// Lists the clusters that adjoin each part. part_of: by cluster.
void findAdjoining(std::span<const std::uint32_t> part_of, const ParallelFor& parallel_for, SurfaceSet& set) {
  base::Rows<std::uint32_t> clusters;  // by part
  base::groupIntoRows(parallel_for, set.parts.size(), set.chains.size(), clusters.first(), clusters.all(),
                      [&](std::size_t begin, std::size_t end, auto&& pair) {
                        for (std::size_t i = begin; i < end; ++i) {
                          const std::span<const ChainUse> uses = set.usesOf(set.chains[i]);
                          forEachWhole(uses, part_of, [&](std::uint32_t part, std::span<const ChainUse>) {
                            for (const ChainUse& b : uses) {
                              if (part_of[b.cluster] != part) {
                                pair(part, b.cluster);
                              }
                            }
                          });
                        }
                      });
  makeUnique(parallel_for, clusters, set.first_adjoining, set.adjoining);
}

// Lists the chains at which wholes end: by whole, of so many, ascending. whole_of: by cluster.
void listBoundaries(std::span<const std::uint32_t> whole_of, std::size_t wholes,
                    const ParallelFor& parallel_for, const SurfaceSet& set, LargeVector<std::uint32_t>& first,
                    LargeVector<PatchChain>& chains) {
  base::groupIntoRows(parallel_for, wholes, set.chains.size(), first, chains,
                      [&](std::size_t begin, std::size_t end, auto&& pair) {
                        for (std::size_t i = begin; i < end; ++i) {
                          forEachWhole(set.usesOf(set.chains[i]), whole_of,
                                       [&](std::uint32_t whole, std::span<const ChainUse> uses) {
                                         std::int32_t value = 0;
                                         for (const ChainUse& use : uses) {
                                           value += use.value;
                                         }
                                         if (value != 0) {
                                           pair(whole, PatchChain{static_cast<std::uint32_t>(i), value});
                                         }
                                       });
                        }
                      });
}

// Lists the boundaries of patches, and counts the edges of those of patches and parts. Both: by cluster.
void findBoundaries(std::span<const std::uint32_t> patch_of, std::span<const std::uint32_t> part_of,
                    const ParallelFor& parallel_for, SurfaceSet& set) {
  const auto edgeCount = [&](std::span<const PatchChain> chains) {
    std::uint32_t count = 0;
    for (const PatchChain& chain : chains) {
      count += set.chains[chain.chain].vertex_count - 1;
    }
    return count;
  };
  base::Rows<PatchChain> of_part;
  listBoundaries(part_of, set.parts.size(), parallel_for, set, of_part.first(), of_part.all());
  base::forEach(parallel_for, set.parts.size(),
                [&](std::uint32_t p) { set.parts[p].edge_count = edgeCount(of_part[p]); });
  LargeVector<std::uint32_t> first;
  listBoundaries(patch_of, set.patches.size(), parallel_for, set, first, set.patch_chains);
  base::forEach(parallel_for, set.patches.size(), [&](std::uint32_t p) {
    set.patches[p].first_chain = first[p];
    set.patches[p].chain_count = first[p + 1] - first[p];
    set.patches[p].edge_count = edgeCount(set.chainsOf(set.patches[p]));
  });
}

float diameter(const Box& box) {
  return length(box.extent());
}

// Lists the parts of each object, the largest first. part_of: by triangle of the mesh.
void listByObject(const occluders::SurfaceMesh& mesh, std::span<const std::uint32_t> part_of,
                  std::size_t objects, const ParallelFor& parallel_for, SurfaceSet& set) {
  base::Rows<std::uint32_t> parts;  // by object
  base::groupIntoRows(
      parallel_for, objects, mesh.triangles.size(), parts.first(), parts.all(),
      [&](std::size_t begin, std::size_t end, auto&& pair) {
        for (std::size_t t = begin; t < end; ++t) {
          // Most triangles have the same part and object as the one before.
          if (t == begin || part_of[t] != part_of[t - 1] || mesh.objects[t] != mesh.objects[t - 1]) {
            pair(mesh.objects[t], part_of[t]);
          }
        }
      });
  makeUnique(parallel_for, parts, set.first_of_object, set.of_object);
  set.sizes_of_object.resize(set.of_object.size());
  set.object_bounds.resize(objects);
  base::forEach(parallel_for, objects, [&](std::uint32_t object) {
    const std::uint32_t first = set.first_of_object[object], end = set.first_of_object[object + 1];
    std::stable_sort(set.of_object.begin() + first, set.of_object.begin() + end,
                     [&](std::uint32_t a, std::uint32_t b) {
                       return diameter(set.part_bounds[a]) > diameter(set.part_bounds[b]);
                     });
    for (std::uint32_t i = first; i < end; ++i) {
      set.object_bounds[object].extend(set.part_bounds[set.of_object[i]]);
      set.sizes_of_object[i] = diameter(set.part_bounds[set.of_object[i]]);
    }
  });
  for (std::uint32_t object = 0; object < objects; ++object) {
    if (set.first_of_object[object + 1] > set.first_of_object[object]) {
      set.objects.push_back(ObjectId(object));
    }
  }
}

}  // namespace

SurfaceSet findSurfaces(const SceneView& scene, const SurfaceSettings& settings,
                        const ParallelFor& parallel_for) {
  SurfaceSet set;
  occluders::SurfaceMesh mesh = occluders::weld(scene, parallel_for);
  occluders::connect(mesh, settings.join_edges, parallel_for);
  occluders::Gathered gathered = occluders::gatherTriangles(scene, mesh, settings, parallel_for, set);
  listByObject(mesh, gathered.part_of, scene.objects.size(), parallel_for, set);
  base::freeVector(gathered.part_of);
  occluders::findChains(mesh, gathered, parallel_for, set);
  set.vertices = std::move(mesh.vertices);
  LargeVector<std::uint32_t> part_of(set.clusters.size()), patch_of(set.clusters.size());
  base::forEach(parallel_for, set.parts.size(), [&](std::uint32_t part) {
    const SurfacePart& of = set.parts[part];
    for (std::uint32_t patch = of.first_patch; patch < of.first_patch + of.patch_count; ++patch) {
      const std::uint32_t first = set.patches[patch].first_cluster;
      std::fill_n(part_of.begin() + first, set.patches[patch].cluster_count, part);
      std::fill_n(patch_of.begin() + first, set.patches[patch].cluster_count, patch);
    }
  });
  findAdjoining(part_of, parallel_for, set);
  findBoundaries(patch_of, part_of, parallel_for, set);
  return set;
}

}  // namespace sightline
