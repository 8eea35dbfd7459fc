#pragma once

// Whole surfaces as occluders: the opaque triangles of a scene in connected clusters.
//
// What a surface hides depends on its boundary alone. Give each triangle its three directed edges and cancel
// every edge against its opposite: what remains is the boundary of the surface, and the winding number of its
// image about a direction is the number of times that a line of sight crosses the surface, front first.
// docs/conservative.md, "Surfaces", has the argument.

#include <cstddef>
#include <cstdint>
#include <span>

#include "sightline/base/ids.h"
#include "sightline/base/large_vector.h"
#include "sightline/base/parallel_for.h"
#include "sightline/base/result.h"
#include "sightline/math/box.h"
#include "sightline/math/mat4.h"
#include "sightline/math/plane.h"
#include "sightline/scene/scene.h"

namespace sightline {

// How often the triangles of a cluster run along a chain in its direction, less how often they run back.
struct ChainUse {
  std::uint32_t cluster = 0;  // into SurfaceSet::clusters
  std::int32_t value = 0;     // not 0; positive: the cluster lies to the left, seen from its front
};

// A chain is a path of mesh edges at which the same clusters end.
struct SurfaceChain {
  std::uint32_t first_vertex = 0, vertex_count = 0;  // into SurfaceSet::chain_vertices, at least two
  std::uint32_t first_use = 0, use_count = 0;        // into SurfaceSet::uses, ascending by cluster
};

// A cluster is a set of connected triangles of similar direction, all single-sided or all double-sided. They
// count as an occluder together or not at all.
struct SurfaceCluster {
  std::uint32_t first_triangle = 0, triangle_count = 0;  // into SurfaceSet::triangles
  std::uint32_t first_chain = 0, chain_count = 0;        // into SurfaceSet::cluster_chains
  // All of the cluster lies in front of this plane or on it, within `thickness` metres of it. The unit normal
  // is that of the cluster on average.
  Plane support{};
  double thickness = 0.0;
  bool double_sided = false;
};

// How often the triangles of a patch run along a chain in its direction, less how often they run back.
struct PatchChain {
  std::uint32_t chain = 0;  // into SurfaceSet::chains
  std::int32_t value = 0;   // not 0; positive: the patch lies to the left, seen from its front
};

// A patch is a set of connected clusters of similar direction.
struct SurfacePatch {
  std::uint32_t first_cluster = 0, cluster_count = 0;  // into SurfaceSet::clusters
  std::uint32_t first_chain = 0, chain_count = 0;      // into SurfaceSet::patch_chains
  std::uint32_t edge_count = 0;                        // of its boundary
  // These have the same meaning as those of a cluster.
  Plane support{};
  double thickness = 0.0;
  bool double_sided = false;
  // The angle between the normal of any of its triangles and that of `support` is at most that of this
  // cosine, rounded down; -1 if it may be any.
  float cone_cosine = -1.0f;
};

// A part is a set of connected patches.
struct SurfacePart {
  std::uint32_t first_patch = 0, patch_count = 0;  // into SurfaceSet::patches
  std::uint32_t edge_count = 0;                    // of its boundary
};

// Tells a set from all others, also from one that lay in the same place before: each has a number of its own,
// and a copy that of its original.
class SurfaceSetNumber {
 public:
  SurfaceSetNumber();
  friend bool operator==(const SurfaceSetNumber&, const SurfaceSetNumber&) = default;

 private:
  std::uint64_t value_;
};

// Made by findSurfaces() and not to be changed by hand: what is known of a set is kept from view to view.
struct SurfaceSet {
  SurfaceSetNumber number{};
  // Scene space; no two are equal.
  LargeVector<Vec3f> vertices{};
  // Each triangle has three vertices, counter-clockwise as seen from its front; triangles are sorted by
  // cluster.
  LargeVector<std::uint32_t> triangles{};
  LargeVector<SurfaceCluster> clusters{};  // by patch
  LargeVector<SurfacePatch> patches{};     // by part
  LargeVector<SurfacePart> parts{};
  LargeVector<Box> cluster_bounds{}, patch_bounds{}, part_bounds{};
  Box bounds{};  // of all
  // Clusters that adjoin a part and are not of it: by part, and one more, into `adjoining`.
  LargeVector<std::uint32_t> first_adjoining{}, adjoining{};
  LargeVector<std::uint32_t> first_of_object{};  // by ObjectId, and one more; into of_object
  LargeVector<std::uint32_t> of_object{};        // numbers of parts, by object, the largest ones first
  LargeVector<float> sizes_of_object{};          // the diameters of their boxes, metres
  LargeVector<ObjectId> objects{};               // that have parts, ascending
  LargeVector<Box> object_bounds{};              // of all parts of an object, by ObjectId
  LargeVector<SurfaceChain> chains{};
  LargeVector<ChainUse> uses{};
  LargeVector<std::uint32_t> cluster_chains{};  // numbers of chains, by cluster
  LargeVector<PatchChain> patch_chains{};       // the boundaries of patches, by patch
  LargeVector<Vec3f> chain_vertices{};          // by chain, scene space

  // Numbers of the parts that have triangles of an object, those with the largest boxes first.
  std::span<const std::uint32_t> partsOf(ObjectId object) const {
    return std::size_t{object.value} + 1 < first_of_object.size()
               ? std::span(of_object).subspan(
                     first_of_object[object.value],
                     first_of_object[object.value + 1] - first_of_object[object.value])
               : std::span<const std::uint32_t>();
  }
  // Their sizes, by number in partsOf().
  std::span<const float> sizesOf(ObjectId object) const {
    const std::size_t count = partsOf(object).size();
    return count > 0 ? std::span(sizes_of_object).subspan(first_of_object[object.value], count)
                     : std::span<const float>();
  }
  std::span<const SurfacePatch> patchesOf(const SurfacePart& p) const {
    return std::span(patches).subspan(p.first_patch, p.patch_count);
  }
  // Numbers of the clusters that share edges with a part and are not of it, ascending.
  std::span<const std::uint32_t> adjoiningOf(std::uint32_t part) const {
    return std::span(adjoining).subspan(first_adjoining[part],
                                        first_adjoining[part + 1] - first_adjoining[part]);
  }
  std::span<const std::uint32_t> trianglesOf(const SurfaceCluster& c) const {
    return std::span(triangles).subspan(std::size_t{3} * c.first_triangle, std::size_t{3} * c.triangle_count);
  }
  std::span<const std::uint32_t> chainsOf(const SurfaceCluster& c) const {
    return std::span(cluster_chains).subspan(c.first_chain, c.chain_count);
  }
  std::span<const PatchChain> chainsOf(const SurfacePatch& p) const {
    return std::span(patch_chains).subspan(p.first_chain, p.chain_count);
  }
  std::span<const Vec3f> verticesOf(const SurfaceChain& c) const {
    return std::span(chain_vertices).subspan(c.first_vertex, c.vertex_count);
  }
  std::span<const ChainUse> usesOf(const SurfaceChain& c) const {
    return std::span(uses).subspan(c.first_use, c.use_count);
  }
};

// Surfaces that move as one, as a door or a train does, or that are there several times, and where they are
// in a frame.
struct MovingSurfaces {
  const SurfaceSet* surfaces = nullptr;  // in a space of their own; null: none
  // Affine; it may scale, shear, and mirror, which leaves fronts fronts. With another matrix, and with one
  // that stretches a direction some thousand times as much as another, nothing is drawn.
  Mat4 scene_from_surfaces{};
};

struct SurfaceSettings {
  // Triangles of a part, of a patch and of a cluster, 1 to 65,535 each. More triangles mean a shorter
  // boundary for each, but a cluster is drawn as a whole, and the depth of a part is that of its farthest
  // cluster in a pixel.
  std::uint32_t part_triangles = 1024, patch_triangles = 1024, cluster_triangles = 16;
  // Largest angle between the normal of a triangle and that of the first one of its patch or cluster,
  // degrees.
  double max_angle_deg = 10.0;
  // Whether edges at which triangles do not cancel are divided at the vertices of other such edges that lie
  // on them exactly, so that merged rectangles and rows of panels join.
  bool join_edges = true;
};

// Finds the surfaces of all opaque triangles of a scene. Equal positions are one vertex, whatever objects
// they belong to, so objects must not move apart. Triangles with coordinates that are not finite are left
// out. The result does not depend on the threads.
SurfaceSet findSurfaces(const SceneView& scene, const SurfaceSettings& settings = {},
                        const ParallelFor& parallel_for = serialFor);

// The surfaces as bytes, to be read again instead of found: on a machine of the same kind, by a program of
// the same version. They say neither of which scene nor with which settings they were found.
LargeVector<std::byte> surfaceBytes(const SurfaceSet& set);
// Error if they are cut off, of another version, or name what they do not have; such a set cannot be read
// beyond its arrays, and all of its numbers are finite. Whether they are those that were written, of this
// scene, is for the caller to check, by a checksum: surfaces of another scene hide what is visible. If the
// bytes have an owner and begin at a multiple of 16, the arrays of the set lie in them and keep the owner.
// object_count: of the scene.
Result<SurfaceSet> surfacesFrom(const SharedBytes& bytes, std::uint32_t object_count);

}  // namespace sightline
