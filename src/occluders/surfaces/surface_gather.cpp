// Parts are gathered one after the other, for each takes what the ones before it have left. Within each part
// patches and clusters are then gathered on their own.

#include "src/occluders/surfaces/surface_gather.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <span>
#include <utility>
#include <vector>

#include "src/base/parts.h"
#include "src/base/rows.h"
#include "src/base/scratch_array.h"

namespace sightline::occluders {
namespace {

constexpr std::size_t kTrianglesOfChunk = 16384;
constexpr double kRounding = 1e-6;  // far above that of cosines, and of a plane through single precision
constexpr std::uint32_t kUngathered = 0xffffffffu;
// At an edge with more triangles than this, a part looks for more of them only once.
constexpr std::size_t kManySides = 64;

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

// Twice as long as the area. corners: three vertices.
Vec3d areaNormal(std::span<const Vec3f> vertices, const std::uint32_t* corners) {
  const Vec3d at(vertices[corners[0]]);
  return cross(Vec3d(vertices[corners[1]]) - at, Vec3d(vertices[corners[2]]) - at);
}
// Zero for a triangle without area.
Vec3d unitNormal(std::span<const Vec3f> vertices, const std::uint32_t* corners) {
  const Vec3d normal = areaNormal(vertices, corners);
  const double size = length(normal);
  return size > 0.0 ? normal / size : Vec3d{};
}

// Where a part stands with a crowded edge.
struct CrowdedVisit {
  std::uint32_t first_free = 0;      // no side before this one is that of a free triangle
  std::uint32_t seed = kUngathered;  // of the last part that looked for triangles there
};

// Gathers triangles of the same sidedness from a first one on over its edges, one part after the other. A
// part that is half full grows no farther over T-junctions: what it reached there would be of many objects,
// and the depth of a part is that of its farthest one.
PartTriangles gatherParts(const SceneView& scene, const SurfaceMesh& mesh, std::uint32_t max_triangles) {
  // Until a triangle is gathered, its place says which sides it has.
  constexpr std::uint32_t kFree = 0xfffffffeu;
  const auto freeOf = [](bool double_sided) { return double_sided ? kFree : kFree + 1; };
  const auto count = static_cast<std::uint32_t>(mesh.triangleCount());
  PartTriangles parts{LargeVector<std::uint32_t>(count), LargeVector<std::uint32_t>(count)};
  for (std::uint32_t t = 0; t < count; ++t) {
    parts.place_of[t] = freeOf(scene.materialOf(scene.objects[mesh.objects[t]]).double_sided);
  }
  std::vector<CrowdedVisit> visits(mesh.crowded.count());
  std::uint32_t end = 0;
  for (std::uint32_t seed = 0; seed < count; ++seed) {
    const std::uint32_t free = parts.place_of[seed];
    if (free < kFree) {
      continue;
    }
    const std::uint32_t most = end + max_triangles, half_full = end + max_triangles / 2;
    std::uint32_t from = seed;
    const auto take = [&](std::uint32_t t) {
      if (end < most && parts.place_of[t] == free && (end < half_full || !mesh.meetAtJunction(from, t))) {
        parts.place_of[t] = end;
        parts.triangles[end++] = t;
      }
    };
    const auto takeBeyond = [&](Corner corner) {
      const std::uint32_t edge = mesh.beyond[corner] - SurfaceMesh::kCrowded;
      if (edge >= visits.size() || mesh.crowded[edge].size() <= kManySides) {
        mesh.forEachBeyond(corner, take);
        return;
      }
      CrowdedVisit& visit = visits[edge];
      if (std::exchange(visit.seed, seed) == seed) {
        return;
      }
      const std::span<const Side> sides = mesh.crowded[edge];
      while (visit.first_free < sides.size() && parts.place_of[sides[visit.first_free].triangle()] < kFree) {
        ++visit.first_free;
      }
      for (std::size_t i = visit.first_free; i < sides.size() && end < most; ++i) {
        take(sides[i].triangle());
      }
    };
    std::uint32_t next = end;
    parts.place_of[seed] = end;
    parts.triangles[end++] = seed;
    for (; next < end && end < most; ++next) {
      from = parts.triangles[next];
      const Corner corner = 3 * from;
      takeBeyond(corner);
      takeBeyond(corner + 1);
      takeBeyond(corner + 2);
    }
    parts.first.push_back(end);
  }
  return parts;
}

// How the triangles of some parts are divided, part after part.
struct Division {
  std::vector<std::uint32_t> patch_counts;    // by part: patches
  std::vector<std::uint32_t> cluster_counts;  // by patch: clusters
  std::vector<std::uint32_t> sizes;           // by cluster: triangles
};

// Divides one part after the other into patches and clusters. Its triangles have numbers of their own, in the
// order in which they were gathered.
class PartDivider {
 public:
  PartDivider(const SurfaceMesh& mesh, PartTriangles& parts, const SurfaceSettings& settings)
      : mesh_(mesh),
        parts_(parts),
        patch_triangles_(clamped(settings.patch_triangles)),
        cluster_triangles_(clamped(settings.cluster_triangles)),
        min_cosine_(cosineOf(settings.max_angle_deg)) {}

  // triangles, cluster_of: of the whole set. Clusters are numbered from the first one of the division. The
  // triangles of the part are put into the order in which they were gathered to patches.
  void divide(std::uint32_t part, Division& division, std::span<std::uint32_t> triangles,
              std::span<std::uint32_t> cluster_of) {
    begin_part_ = parts_.first[part];
    size_ = parts_.first[part + 1] - begin_part_;
    look();
    patches_.begin(size_, crowded_.count());
    clusters_.begin(size_, crowded_.count());
    by_patch_.clear();
    division.patch_counts.push_back(0);
    std::uint32_t written = begin_part_;
    for (std::uint32_t seed = 0; seed < size_; ++seed) {
      if (patches_.number_of[seed] != kUngathered) {
        continue;
      }
      gather(seed, patch_triangles_, kUngathered, division.patch_counts.back()++, patches_, in_patch_);
      const std::uint32_t patch = patches_.number_of[seed];
      division.cluster_counts.push_back(0);
      for (const std::uint32_t first : in_patch_) {
        by_patch_.push_back(triangleOf(first));
        if (clusters_.number_of[first] != kUngathered) {
          continue;
        }
        const auto number = static_cast<std::uint32_t>(division.sizes.size());
        if (in_patch_.size() <= cluster_triangles_) {
          // Gathered from the same triangle on, the cluster has the triangles of the patch in the same order.
          in_cluster_ = in_patch_;
          std::for_each(in_patch_.begin(), in_patch_.end(),
                        [&](std::uint32_t i) { clusters_.number_of[i] = number; });
        } else {
          gather(first, cluster_triangles_, patch, number, clusters_, in_cluster_);
        }
        ++division.cluster_counts.back();
        division.sizes.push_back(static_cast<std::uint32_t>(in_cluster_.size()));
        for (const std::uint32_t i : in_cluster_) {
          std::copy_n(mesh_.triangles[triangleOf(i)].begin(), 3, &triangles[3 * std::size_t{written++}]);
          cluster_of[triangleOf(i)] = number;
        }
      }
    }
    std::copy(by_patch_.begin(), by_patch_.end(), parts_.triangles.begin() + begin_part_);
  }

 private:
  // Triangles of a part by the groups to which they were gathered.
  struct Groups {
    std::vector<std::uint32_t> number_of;
    // By crowded edge: the first triangle there that may be free, and the last group that looked for some.
    std::vector<std::uint32_t> first_free, looked;

    void begin(std::size_t triangles, std::size_t crowded) {
      number_of.assign(triangles, kUngathered);
      first_free.assign(crowded, 0);
      looked.assign(crowded, kUngathered);
    }
  };

  std::uint32_t triangleOf(std::uint32_t i) const { return parts_.triangles[begin_part_ + i]; }
  // The number in the part; large for triangles of other parts.
  std::uint32_t numberOf(std::uint32_t t) const { return parts_.place_of[t] - begin_part_; }

  // Finds the normals of the part's triangles and their neighbours.
  void look() {
    normals_.resize(size_);
    neighbours_.resize(std::size_t{3} * size_);
    by_crowded_.clear();
    for (std::uint32_t i = 0; i < size_; ++i) {
      const std::uint32_t t = triangleOf(i);
      normals_[i] = unitNormal(mesh_.vertices, mesh_.triangles[t].data());
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t beyond = mesh_.beyond[3 * t + k];
        neighbours_[std::size_t{3} * i + k] =
            beyond < SurfaceMesh::kCrowded ? numberOf(beyond / 3) : kUngathered;
        if (beyond >= SurfaceMesh::kCrowded && beyond != SurfaceMesh::kNone) {
          by_crowded_.push_back({std::uint64_t{beyond} << 32 | (3 * t + k), 3 * i + k});
        }
      }
    }
    listCrowded();
  }

  // Lists the triangles of the part at each crowded edge, ascending.
  void listCrowded() {
    std::sort(by_crowded_.begin(), by_crowded_.end());
    crowded_.clear();
    for (std::size_t i = 0; i < by_crowded_.size(); ++i) {
      const auto [key, corner] = by_crowded_[i];
      neighbours_[corner] = kFirstCrowded + static_cast<std::uint32_t>(crowded_.count());
      crowded_.add(corner / 3);
      if (i + 1 == by_crowded_.size() || by_crowded_[i + 1].first >> 32 != key >> 32) {
        crowded_.endRow();
      }
    }
  }

  // Gathers triangles of similar direction from a first one on to a group of that number. patch: the one to
  // which they belong; kUngathered: to any. Which triangles may be taken is the same all the while, so one
  // look at each crowded edge finds all of them there.
  void gather(std::uint32_t seed, std::uint32_t max_triangles, std::uint32_t patch, std::uint32_t number,
              Groups& groups, std::vector<std::uint32_t>& members) {
    const Vec3d& first = normals_[seed];
    members.assign(1, seed);
    groups.number_of[seed] = number;
    const auto take = [&](std::uint32_t i) {
      if (groups.number_of[i] == kUngathered && members.size() < max_triangles &&
          (patch == kUngathered || patches_.number_of[i] == patch) &&
          isSimilar(normals_[i], first, min_cosine_)) {
        groups.number_of[i] = number;
        members.push_back(i);
      }
    };
    const auto takeAlong = [&](std::uint32_t crowded) {
      if (std::exchange(groups.looked[crowded], number) == number) {
        return;
      }
      const std::span<const std::uint32_t> triangles = crowded_[crowded];
      std::uint32_t& free = groups.first_free[crowded];
      while (free < triangles.size() && groups.number_of[triangles[free]] != kUngathered) {
        ++free;
      }
      for (std::size_t i = free; i < triangles.size() && members.size() < max_triangles; ++i) {
        take(triangles[i]);
      }
    };
    for (std::size_t next = 0; next < members.size() && members.size() < max_triangles; ++next) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t neighbour = neighbours_[std::size_t{3} * members[next] + k];
        if (neighbour < size_) {
          take(neighbour);
        } else if (neighbour - kFirstCrowded < crowded_.count()) {
          takeAlong(neighbour - kFirstCrowded);
        }
      }
    }
  }

  const SurfaceMesh& mesh_;
  PartTriangles& parts_;
  const std::uint32_t patch_triangles_, cluster_triangles_;
  const double min_cosine_;
  // These belong to the part that is being gathered.
  std::uint32_t begin_part_ = 0, size_ = 0;
  std::vector<Vec3d> normals_;  // unit
  // By corner: a triangle of the part, kFirstCrowded and the number of a crowded edge, or any other number.
  std::vector<std::uint32_t> neighbours_;
  static constexpr std::uint32_t kFirstCrowded = 0x80000000u;
  // The corners at crowded edges, each with the edge and its number in the mesh before.
  std::vector<std::pair<std::uint64_t, std::uint32_t>> by_crowded_;
  base::Rows<std::uint32_t> crowded_;  // the triangles at these edges
  Groups patches_, clusters_;
  std::vector<std::uint32_t> in_patch_, in_cluster_;
  std::vector<std::uint32_t> by_patch_;  // triangles, in the order of patches
};

// Sets where some triangles lie and which way they face. corners_of(i): the three vertices of triangle i of
// `count`. normals: scratch. Part: a SurfaceCluster or a SurfacePatch. Returns the cosine of the greatest
// angle between normals and that of the supporting plane, rounded down.
template <typename CornersOf, typename Part>
double measure(std::span<const Vec3f> vertices, std::uint32_t count, const CornersOf& corners_of,
               std::vector<Vec3d>& normals, Part& part, Box& bounds) {
  Vec3d axis{};
  normals.clear();
  for (std::uint32_t i = 0; i < count; ++i) {
    normals.push_back(areaNormal(vertices, corners_of(i)));
    axis += normals.back();
  }
  const double size = length(axis);
  axis = size > 0.0 ? axis / size : Vec3d{0.0, 0.0, 1.0};
  double cosine = 1.0, lowest = std::numeric_limits<double>::infinity(), highest = -lowest, reach = 0.0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t* const corners = corners_of(i);
    const double twice_area = length(normals[i]);
    cosine = twice_area > 0.0 ? std::min(cosine, dot(normals[i] / twice_area, axis)) : cosine;
    for (int k = 0; k < 3; ++k) {
      const Vec3f& at = vertices[corners[k]];
      const Vec3d p(at);
      bounds.extend(at);
      lowest = std::min(lowest, dot(axis, p));
      highest = std::max(highest, dot(axis, p));
      reach = std::max(reach, maxComponent(abs(p)));
    }
  }
  part.support = {axis, -(lowest - 1e-14 * reach)};
  part.thickness = highest - lowest + 4e-14 * reach;
  return size > 0.0 ? std::max(-1.0, cosine - kRounding) : -1.0;
}

// The first part, patch, cluster and triangle of some parts.
struct Place {
  std::uint32_t part = 0, patch = 0, cluster = 0, triangle = 0;
};

// Fills the parts, patches and clusters of a set from a place on. by_patch: all triangles of the mesh in the
// order in which they were gathered to patches. Each record is zero before it is filled, also between its
// members, for sets are kept as the bytes that they are in memory.
void writeDivision(const SceneView& scene, const SurfaceMesh& mesh, std::span<const std::uint32_t> by_patch,
                   const Division& division, Place at, SurfaceSet& set) {
  std::size_t patch_here = 0, cluster_here = 0;
  std::vector<Vec3d> normals;
  for (const std::uint32_t patch_count : division.patch_counts) {
    SurfacePart& part = set.parts[at.part];
    part.first_patch = at.patch;
    part.patch_count = patch_count;
    const std::uint32_t first = by_patch[at.triangle];
    const bool double_sided = scene.materialOf(scene.objects[mesh.objects[first]]).double_sided;
    Box& part_bounds = set.part_bounds[at.part++];
    for (std::uint32_t i = 0; i < patch_count; ++i) {
      SurfacePatch& patch = *::new (&set.patches[at.patch]) SurfacePatch();
      Box patch_bounds;
      patch.first_cluster = at.cluster;
      patch.cluster_count = division.cluster_counts[patch_here++];
      patch.double_sided = double_sided;
      const std::uint32_t first_triangle = at.triangle;
      double cosine = 1.0;
      for (std::uint32_t k = 0; k < patch.cluster_count; ++k) {
        SurfaceCluster& cluster = *::new (&set.clusters[at.cluster]) SurfaceCluster();
        Box bounds;
        cluster.first_triangle = at.triangle;
        cluster.triangle_count = division.sizes[cluster_here++];
        cluster.double_sided = double_sided;
        cosine = measure(
            mesh.vertices, cluster.triangle_count,
            [&](std::uint32_t t) { return &set.triangles[3 * std::size_t{at.triangle + t}]; }, normals,
            cluster, bounds);
        at.triangle += cluster.triangle_count;
        set.cluster_bounds[at.cluster++] = bounds;
      }
      if (patch.cluster_count == 1) {
        patch.support = set.clusters[at.cluster - 1].support;
        patch.thickness = set.clusters[at.cluster - 1].thickness;
        patch_bounds = set.cluster_bounds[at.cluster - 1];
      } else {
        cosine = measure(
            mesh.vertices, at.triangle - first_triangle,
            [&](std::uint32_t t) { return mesh.triangles[by_patch[first_triangle + t]].data(); }, normals,
            patch, patch_bounds);
      }
      patch.cone_cosine = static_cast<float>(cosine - kRounding);
      set.patch_bounds[at.patch++] = patch_bounds;
      part_bounds.extend(patch_bounds);
    }
  }
}

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

Gathered gatherTriangles(const SceneView& scene, SurfaceMesh& mesh, const SurfaceSettings& settings,
                         const ParallelFor& parallel_for, SurfaceSet& set) {
  PartTriangles parts = gatherParts(scene, mesh, clamped(settings.part_triangles));
  const std::vector<std::uint32_t> first_part = chunksOf(parts.first);
  Gathered gathered;
  gathered.part_of = base::unsetVector<std::uint32_t>(mesh.triangleCount());
  gathered.cluster_of = base::unsetVector<std::uint32_t>(mesh.triangleCount());
  set.triangles = base::unsetVector<std::uint32_t>(3 * mesh.triangleCount());
  std::vector<Division> divisions(first_part.size() - 1);
  parallel_for(static_cast<std::uint32_t>(divisions.size()), [&](std::uint32_t begin, std::uint32_t end) {
    PartDivider divider(mesh, parts, settings);
    for (std::uint32_t c = begin; c < end; ++c) {
      for (std::uint32_t p = first_part[c]; p < first_part[c + 1]; ++p) {
        divider.divide(p, divisions[c], set.triangles, gathered.cluster_of);
      }
    }
  });

  // Their memory is of use to what follows.
  base::freeVector(parts.place_of);
  mesh.forgetJunctions();

  // Where each chunk begins, and one more.
  std::vector<Place> places(1);
  for (std::size_t c = 0; c < divisions.size(); ++c) {
    const Place& last = places.back();
    places.push_back({first_part[c + 1],
                      last.patch + static_cast<std::uint32_t>(divisions[c].cluster_counts.size()),
                      last.cluster + static_cast<std::uint32_t>(divisions[c].sizes.size()),
                      parts.first[first_part[c + 1]]});
  }
  set.parts.resize(parts.first.size() - 1);
  set.part_bounds.resize(set.parts.size());
  set.patches = base::unsetVector<SurfacePatch>(places.back().patch);
  set.patch_bounds = base::unsetVector<Box>(places.back().patch);
  set.clusters = base::unsetVector<SurfaceCluster>(places.back().cluster);
  set.cluster_bounds = base::unsetVector<Box>(places.back().cluster);
  base::forEach(parallel_for, divisions.size(), [&](std::uint32_t c) {
    writeDivision(scene, mesh, parts.triangles, divisions[c], places[c], set);
    for (std::uint32_t p = first_part[c]; p < first_part[c + 1]; ++p) {
      for (std::uint32_t i = parts.first[p]; i < parts.first[p + 1]; ++i) {
        gathered.part_of[parts.triangles[i]] = p;
        gathered.cluster_of[parts.triangles[i]] += places[c].cluster;
      }
    }
  });
  for (const Box& bounds : set.part_bounds) {
    set.bounds.extend(bounds);
  }
  gathered.by_patch = std::move(parts.triangles);
  return gathered;
}

}  // namespace sightline::occluders
