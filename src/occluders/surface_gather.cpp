// Parts are gathered one after the other, for each takes what the ones before it have left. Within each part
// patches and clusters are then gathered on their own.

#include "src/occluders/surface_gather.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "src/base/part_store.h"
#include "src/base/parts.h"

namespace sightline::occluders {
namespace {

constexpr std::size_t kTrianglesOfChunk = 16384;
constexpr double kRounding = 1e-6;  // far above that of cosines, and of a plane through single precision
constexpr std::uint32_t kUngathered = 0xffffffffu;

std::uint32_t clamped(std::uint32_t triangles) {
  return std::clamp(triangles, 1u, 65535u);
}

// The triangles of a mesh by part, in the order in which they were gathered.
struct PartTriangles {
  LargeVector<std::uint32_t> triangles;
  LargeVector<std::uint32_t> place_of;     // by triangle, in `triangles`
  std::vector<std::uint32_t> first = {0};  // by part, into triangles; and one more
};

double cosineOf(double degrees) {
  return std::cos(std::clamp(degrees, 0.0, 180.0) * 0.017453292519943295);
}

// Whether a triangle may be gathered with a first one. Normals: unit, zero for a triangle without area.
bool isSimilar(const Vec3d& normal, const Vec3d& first, double min_cosine) {
  return normal == Vec3d{} || dot(normal, first) >= min_cosine;
}

// Twice as long as the area.
Vec3d areaNormal(const SurfaceMesh& mesh, std::uint32_t triangle) {
  const auto [a, b, c] = mesh.triangles[triangle];
  const Vec3d at(mesh.vertices[a]);
  return cross(Vec3d(mesh.vertices[b]) - at, Vec3d(mesh.vertices[c]) - at);
}

LargeVector<Vec3d> unitNormals(const SurfaceMesh& mesh, const ParallelFor& parallel_for) {
  LargeVector<Vec3d> normals(mesh.triangleCount());
  base::forEach(parallel_for, normals.size(), [&](std::uint32_t t) {
    const Vec3d normal = areaNormal(mesh, t);
    const double size = length(normal);
    normals[t] = size > 0.0 ? normal / size : Vec3d{};
  });
  return normals;
}

// Gathers triangles of the same sidedness from a first one on over its edges, one part after the other. A
// part that is half full grows no farther over T-junctions: what it reached there would be of many objects,
// and the depth of a part is that of its farthest one.
PartTriangles gatherParts(const SceneView& scene, const SurfaceMesh& mesh, std::span<const Vec3d> normals,
                          std::uint32_t max_triangles) {
  // Normals may be any. Those that are opposite but for rounding may have a cosine below this all the same:
  // then they are not gathered together.
  const double min_cosine = cosineOf(180.0);
  // Until a triangle is gathered, its place says which sides it has.
  constexpr std::uint32_t kFree = 0xfffffffeu;
  const auto freeOf = [](bool double_sided) { return double_sided ? kFree : kFree + 1; };
  const auto count = static_cast<std::uint32_t>(mesh.triangleCount());
  PartTriangles parts{LargeVector<std::uint32_t>(count), LargeVector<std::uint32_t>(count)};
  for (std::uint32_t t = 0; t < count; ++t) {
    parts.place_of[t] = freeOf(scene.materialOf(scene.objects[mesh.objects[t]]).double_sided);
  }
  std::uint32_t end = 0;
  for (std::uint32_t seed = 0; seed < count; ++seed) {
    const std::uint32_t free = parts.place_of[seed];
    if (free < kFree) {
      continue;
    }
    const std::uint32_t most = end + max_triangles, half_full = end + max_triangles / 2;
    std::uint32_t from = seed;
    const auto take = [&](std::uint32_t t) {
      if (end < most && parts.place_of[t] == free && isSimilar(normals[t], normals[seed], min_cosine) &&
          (end < half_full || !mesh.meetAtJunction(from, t))) {
        parts.place_of[t] = end;
        parts.triangles[end++] = t;
      }
    };
    std::uint32_t next = end;
    parts.place_of[seed] = end;
    parts.triangles[end++] = seed;
    for (; next < end; ++next) {
      from = parts.triangles[next];
      const Corner corner = 3 * from;
      mesh.forEachBeyond(corner, take);
      mesh.forEachBeyond(corner + 1, take);
      mesh.forEachBeyond(corner + 2, take);
    }
    parts.first.push_back(end);
  }
  return parts;
}

// What was gathered in some parts. Numbers of patches and clusters count from the first one here.
struct Chunk {
  std::vector<SurfacePatch> patches;
  std::vector<SurfaceCluster> clusters;
  std::vector<Box> patch_bounds, cluster_bounds;

  void clear() {
    patches.clear();
    clusters.clear();
    patch_bounds.clear();
    cluster_bounds.clear();
  }
};

// A PartStore keeps these copies of a chunk's arrays.
struct KeptChunk {
  std::span<SurfacePatch> patches;
  std::span<const SurfaceCluster> clusters;
  std::span<const Box> patch_bounds, cluster_bounds;
};

// Divides one part after the other into patches and clusters. Its triangles have numbers of their own, in the
// order in which they were gathered.
class PartDivider {
 public:
  PartDivider(const SurfaceMesh& mesh, std::span<const Vec3d> normals, const PartTriangles& parts,
              const SurfaceSettings& settings)
      : mesh_(mesh),
        normals_(normals),
        parts_(parts),
        patch_triangles_(clamped(settings.patch_triangles)),
        cluster_triangles_(clamped(settings.cluster_triangles)),
        min_cosine_(cosineOf(settings.max_angle_deg)) {}

  // triangles, cluster_of: of the whole set. Clusters are numbered from the first one of the chunk.
  void divide(std::uint32_t part, bool double_sided, Chunk& chunk, std::span<std::uint32_t> triangles,
              std::span<std::uint32_t> cluster_of) {
    begin_part_ = parts_.first[part];
    size_ = parts_.first[part + 1] - begin_part_;
    patch_of_.assign(size_, kUngathered);
    cluster_of_.assign(size_, kUngathered);
    std::uint32_t written = begin_part_;
    for (std::uint32_t seed = 0; seed < size_; ++seed) {
      if (patch_of_[seed] != kUngathered) {
        continue;
      }
      const auto patch_number = static_cast<std::uint32_t>(chunk.patches.size());
      gather(seed, patch_triangles_, kUngathered, patch_number, patch_of_, in_patch_);
      SurfacePatch& patch = chunk.patches.emplace_back();
      patch.first_cluster = static_cast<std::uint32_t>(chunk.clusters.size());
      double cosine = 1.0;
      for (const std::uint32_t first : in_patch_) {
        if (cluster_of_[first] != kUngathered) {
          continue;
        }
        const auto number = static_cast<std::uint32_t>(chunk.clusters.size());
        if (in_patch_.size() <= cluster_triangles_) {
          // Gathered from the same triangle on, the cluster has the triangles of the patch in the same order.
          in_cluster_ = in_patch_;
          std::for_each(in_patch_.begin(), in_patch_.end(),
                        [&](std::uint32_t i) { cluster_of_[i] = number; });
        } else {
          gather(first, cluster_triangles_, patch_number, number, cluster_of_, in_cluster_);
        }
        SurfaceCluster& cluster = chunk.clusters.emplace_back();
        cluster.first_triangle = written;
        cluster.triangle_count = static_cast<std::uint32_t>(in_cluster_.size());
        cosine = measure(in_cluster_, cluster, chunk.cluster_bounds.emplace_back());
        cluster.double_sided = double_sided;
        for (const std::uint32_t i : in_cluster_) {
          std::copy_n(mesh_.triangles[triangleOf(i)].begin(), 3, &triangles[3 * std::size_t{written++}]);
          cluster_of[triangleOf(i)] = number;
        }
      }
      if (in_patch_.size() <= cluster_triangles_) {
        patch.support = chunk.clusters.back().support;
        patch.thickness = chunk.clusters.back().thickness;
        chunk.patch_bounds.push_back(chunk.cluster_bounds.back());
      } else {
        cosine = measure(in_patch_, patch, chunk.patch_bounds.emplace_back());
      }
      patch.cone_cosine = static_cast<float>(cosine - kRounding);
      patch.double_sided = double_sided;
      patch.cluster_count = static_cast<std::uint32_t>(chunk.clusters.size()) - patch.first_cluster;
    }
  }

 private:
  std::uint32_t triangleOf(std::uint32_t i) const { return parts_.triangles[begin_part_ + i]; }

  // Gathers triangles of similar direction from a first one on, which get a number in number_of. patch: the
  // one to which they belong; kUngathered: to any.
  void gather(std::uint32_t seed, std::uint32_t max_triangles, std::uint32_t patch, std::uint32_t number,
              std::vector<std::uint32_t>& number_of, std::vector<std::uint32_t>& members) {
    const Vec3d& first = normals_[triangleOf(seed)];
    members.assign(1, seed);
    number_of[seed] = number;
    const auto take = [&](std::uint32_t t) {
      const std::uint32_t i = parts_.place_of[t] - begin_part_;  // large if t is of another part
      if (i < size_ && number_of[i] == kUngathered && members.size() < max_triangles &&
          (patch == kUngathered || patch_of_[i] == patch) && isSimilar(normals_[t], first, min_cosine_)) {
        number_of[i] = number;
        members.push_back(i);
      }
    };
    for (std::size_t next = 0; next < members.size() && members.size() < max_triangles; ++next) {
      const Corner corner = 3 * triangleOf(members[next]);
      mesh_.forEachBeyond(corner, take);
      mesh_.forEachBeyond(corner + 1, take);
      mesh_.forEachBeyond(corner + 2, take);
    }
  }

  // Sets where some triangles lie and which way they face. Part: a SurfaceCluster or a SurfacePatch. Returns
  // the cosine of the greatest angle between normals and that of the supporting plane, rounded down.
  template <typename Part>
  double measure(std::span<const std::uint32_t> members, Part& part, Box& bounds) const {
    Vec3d axis{};
    for (const std::uint32_t i : members) {
      axis += areaNormal(mesh_, triangleOf(i));
    }
    const double size = length(axis);
    axis = size > 0.0 ? axis / size : Vec3d{0.0, 0.0, 1.0};
    double cosine = 1.0, lowest = std::numeric_limits<double>::infinity(), highest = -lowest, reach = 0.0;
    for (const std::uint32_t i : members) {
      const Vec3d& normal = normals_[triangleOf(i)];
      cosine = normal == Vec3d{} ? cosine : std::min(cosine, dot(normal, axis));
      for (const std::uint32_t v : mesh_.triangles[triangleOf(i)]) {
        const Vec3d p(mesh_.vertices[v]);
        bounds.extend(mesh_.vertices[v]);
        lowest = std::min(lowest, dot(axis, p));
        highest = std::max(highest, dot(axis, p));
        reach = std::max(reach, maxComponent(abs(p)));
      }
    }
    part.support = {axis, -(lowest - 1e-14 * reach)};
    part.thickness = highest - lowest + 4e-14 * reach;
    return size > 0.0 ? std::max(-1.0, cosine - kRounding) : -1.0;
  }

  const SurfaceMesh& mesh_;
  std::span<const Vec3d> normals_;
  const PartTriangles& parts_;
  const std::uint32_t patch_triangles_, cluster_triangles_;
  const double min_cosine_;
  // These belong to the part that is being gathered.
  std::uint32_t begin_part_ = 0, size_ = 0;
  std::vector<std::uint32_t> patch_of_, cluster_of_;
  std::vector<std::uint32_t> in_patch_, in_cluster_;
};

// Consecutive parts with about as many triangles: the first part of each chunk, and one more.
std::vector<std::uint32_t> chunksOf(std::span<const std::uint32_t> first_of_part) {
  std::vector<std::uint32_t> chunks(1, 0);
  for (std::uint32_t part = 1; part < first_of_part.size(); ++part) {
    if (first_of_part[part] - first_of_part[chunks.back()] >= kTrianglesOfChunk ||
        part + 1 == first_of_part.size()) {
      chunks.push_back(part);
    }
  }
  return chunks;
}

}  // namespace

Gathered gatherTriangles(const SceneView& scene, const SurfaceMesh& mesh, const SurfaceSettings& settings,
                         const ParallelFor& parallel_for, SurfaceSet& set) {
  LargeVector<Vec3d> normals = unitNormals(mesh, parallel_for);
  PartTriangles parts = gatherParts(scene, mesh, normals, clamped(settings.part_triangles));
  const std::vector<std::uint32_t> first_part = chunksOf(parts.first);
  Gathered gathered;
  gathered.part_of = base::unsetVector<std::uint32_t>(mesh.triangleCount());
  gathered.cluster_of = base::unsetVector<std::uint32_t>(mesh.triangleCount());
  set.triangles = base::unsetVector<std::uint32_t>(3 * mesh.triangleCount());
  set.parts.resize(parts.first.size() - 1);
  set.part_bounds.resize(set.parts.size());
  base::PartStore store;
  std::vector<KeptChunk> chunks(first_part.size() - 1);
  parallel_for(static_cast<std::uint32_t>(chunks.size()), [&](std::uint32_t begin, std::uint32_t end) {
    Chunk chunk;
    PartDivider divider(mesh, normals, parts, settings);
    for (std::uint32_t c = begin; c < end; ++c) {
      chunk.clear();
      for (std::uint32_t p = first_part[c]; p < first_part[c + 1]; ++p) {
        const std::uint32_t first = parts.triangles[parts.first[p]];
        SurfacePart& part = set.parts[p];
        part.first_patch = static_cast<std::uint32_t>(chunk.patches.size());
        divider.divide(p, scene.materialOf(scene.objects[mesh.objects[first]]).double_sided, chunk,
                       set.triangles, gathered.cluster_of);
        part.patch_count = static_cast<std::uint32_t>(chunk.patches.size()) - part.first_patch;
        for (const Box& bounds : std::span(chunk.patch_bounds).subspan(part.first_patch)) {
          set.part_bounds[p].extend(bounds);
        }
      }
      chunks[c] = {store.keep(chunk.patches), store.keep(chunk.clusters), store.keep(chunk.patch_bounds),
                   store.keep(chunk.cluster_bounds)};
    }
  });

  // Their memory is of use to what follows.
  normals = {};
  parts.place_of = {};

  std::vector<std::uint32_t> first_patch(1, 0), first_cluster(1, 0);
  for (const KeptChunk& chunk : chunks) {
    first_patch.push_back(first_patch.back() + static_cast<std::uint32_t>(chunk.patches.size()));
    first_cluster.push_back(first_cluster.back() + static_cast<std::uint32_t>(chunk.clusters.size()));
  }
  set.patches = base::unsetVector<SurfacePatch>(first_patch.back());
  set.patch_bounds = base::unsetVector<Box>(first_patch.back());
  set.clusters = base::unsetVector<SurfaceCluster>(first_cluster.back());
  set.cluster_bounds = base::unsetVector<Box>(first_cluster.back());
  base::forEach(parallel_for, chunks.size(), [&](std::uint32_t c) {
    const KeptChunk& chunk = chunks[c];
    for (SurfacePatch& patch : chunk.patches) {
      patch.first_cluster += first_cluster[c];
    }
    std::copy(chunk.patches.begin(), chunk.patches.end(), set.patches.begin() + first_patch[c]);
    std::copy(chunk.clusters.begin(), chunk.clusters.end(), set.clusters.begin() + first_cluster[c]);
    std::copy(chunk.patch_bounds.begin(), chunk.patch_bounds.end(),
              set.patch_bounds.begin() + first_patch[c]);
    std::copy(chunk.cluster_bounds.begin(), chunk.cluster_bounds.end(),
              set.cluster_bounds.begin() + first_cluster[c]);
    for (std::uint32_t p = first_part[c]; p < first_part[c + 1]; ++p) {
      set.parts[p].first_patch += first_patch[c];
      for (std::uint32_t i = parts.first[p]; i < parts.first[p + 1]; ++i) {
        gathered.part_of[parts.triangles[i]] = p;
        gathered.cluster_of[parts.triangles[i]] += first_cluster[c];
      }
    }
  });
  for (const Box& bounds : set.part_bounds) {
    set.bounds.extend(bounds);
  }
  return gathered;
}

}  // namespace sightline::occluders
