// Surfaces as bytes: a head, then the arrays of SurfaceSet (src/base/array_bytes.h).

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <type_traits>

#include "sightline/occluders/surface_set.h"
#include "src/base/array_bytes.h"

namespace sightline {
namespace {

// The last two letters: raise them with every change of the arrays or of findSurfaces().
constexpr base::ArraysHead kSurfacesHead{
    {'S', 'L', 's', 'u', 'r', 'f', '0', '2'},
    sizeof(SurfaceCluster) | sizeof(SurfacePatch) << 8 | sizeof(SurfaceChain) << 16 |
        (offsetof(SurfaceCluster, double_sided) ^ offsetof(SurfacePatch, double_sided)) << 24};

// Calls visit(array) for all arrays, always in this order. Set: a SurfaceSet, const or not.
template <typename Set, typename Visit>
void forEachSurfaceArray(Set& set, Visit&& visit) {
  visit(set.vertices);
  visit(set.triangles);
  visit(set.clusters);
  visit(set.patches);
  visit(set.parts);
  visit(set.cluster_bounds);
  visit(set.patch_bounds);
  visit(set.part_bounds);
  visit(set.first_adjoining);
  visit(set.adjoining);
  visit(set.first_of_object);
  visit(set.of_object);
  visit(set.sizes_of_object);
  visit(set.objects);
  visit(set.object_bounds);
  visit(set.chains);
  visit(set.uses);
  visit(set.cluster_chains);
  visit(set.patch_chains);
  visit(set.chain_vertices);
}

// It goes on where it could stop: so it takes a fraction of the time of a loop that looks at each number
// alone.
bool allBelow(std::span<const std::uint32_t> numbers, std::size_t end) {
  std::uint32_t largest = 0;
  for (const std::uint32_t number : numbers) {
    largest = std::max(largest, number);
  }
  return numbers.empty() || largest < end;
}

// Whether each item is sound, its range begins where the one before ended, and the last one ends at `size`.
template <typename Items, typename FirstOf, typename CountOf, typename Sound>
bool followEachOther(const Items& items, FirstOf&& first, CountOf&& count, std::size_t size, Sound&& sound) {
  std::uint64_t end = 0;
  for (const auto& item : items) {
    if (first(item) != end || count(item) == 0 || !sound(item)) {
      return false;
    }
    end += count(item);
  }
  return end == size;
}

bool isSound(const Plane& support, double thickness) {
  return isFinite(support.normal) && std::isfinite(support.offset) && std::isfinite(thickness) &&
         thickness >= 0.0;
}

// Whether all points and boxes are such that drawing can compute with them.
bool isFiniteSet(const SurfaceSet& set) {
  const auto all = [](const auto& items, auto&& sound) {
    return std::all_of(items.begin(), items.end(), sound);
  };
  const auto finite = [](const Vec3f& point) { return isFinite(point); };
  const auto well_formed = [](const Box& box) { return box.wellFormed(); };
  return all(set.vertices, finite) && all(set.chain_vertices, finite) &&
         all(set.cluster_bounds, well_formed) && all(set.patch_bounds, well_formed) &&
         all(set.part_bounds, well_formed) &&
         all(set.object_bounds, [](const Box& box) { return box.wellFormed() || box == Box{}; }) &&
         all(set.sizes_of_object, [](float size) { return std::isfinite(size); });
}

// Sums of values at any chain stay far from what a number can hold. A cluster has less than 65,536 triangles,
// each of which may run along a chain once on each of its edges.
constexpr std::int64_t kMostValue = 3 * 65536, kMostSum = 1 << 30;

bool isSmall(std::int32_t value) {
  return value != 0 && std::abs(std::int64_t{value}) <= kMostValue;
}

// What is wrong with the chains, each of which is looked at once; empty if nothing is. Their vertices are
// finite, and their uses name clusters that are there. They lie in the boxes of the clusters that end at
// them, by which drawing tells how large their images may be.
std::string flawOfChains(const SurfaceSet& set) {
  // No two share vertices or uses, so that looking takes no longer than the set is large.
  if (!followEachOther(
          set.chains, [](const SurfaceChain& c) { return c.first_vertex; },
          [](const SurfaceChain& c) { return c.vertex_count; }, set.chain_vertices.size(),
          [](const SurfaceChain& c) { return c.vertex_count >= 2; }) ||
      !followEachOther(
          set.chains, [](const SurfaceChain& c) { return c.first_use; },
          [](const SurfaceChain& c) { return c.use_count; }, set.uses.size(),
          [](const SurfaceChain&) { return true; })) {
    return "its chains are broken";
  }
  for (const SurfaceChain& chain : set.chains) {
    Box vertices;
    for (const Vec3f& vertex : set.verticesOf(chain)) {
      vertices.extend(vertex);
    }
    std::int64_t sum = 0;
    for (const ChainUse& use : set.usesOf(chain)) {
      sum += std::abs(std::int64_t{use.value});
      if (!isSmall(use.value) || sum > kMostSum) {
        return "its edges count for more than they can";
      }
      if (!contains(set.cluster_bounds[use.cluster], vertices)) {
        return "some of its edges lie outside of what they are edges of";
      }
    }
  }
  return "";
}

// What is wrong with the numbers of a set; empty if nothing is: no index leaves its array.
std::string flawOf(const SurfaceSet& set, std::size_t objects) {
  const auto all = [](const auto& items, auto&& sound) {
    return std::all_of(items.begin(), items.end(), sound);
  };
  if (set.triangles.size() % 3 != 0 || !allBelow(set.triangles, set.vertices.size())) {
    return "its triangles name vertices that it does not have";
  }
  if (!followEachOther(
          set.clusters, [](const SurfaceCluster& c) { return c.first_triangle; },
          [](const SurfaceCluster& c) { return c.triangle_count; }, set.triangles.size() / 3,
          [&](const SurfaceCluster& c) {
            return base::isBoolAt(c, offsetof(SurfaceCluster, double_sided)) &&
                   isSound(c.support, c.thickness) &&
                   base::isRange(c.first_chain, c.chain_count, set.cluster_chains.size());
          })) {
    return "its clusters are broken";
  }
  if (!followEachOther(
          set.patches, [](const SurfacePatch& p) { return p.first_cluster; },
          [](const SurfacePatch& p) { return p.cluster_count; }, set.clusters.size(),
          [&](const SurfacePatch& p) {
            return base::isBoolAt(p, offsetof(SurfacePatch, double_sided)) &&
                   isSound(p.support, p.thickness) && p.cone_cosine >= -1.0f && p.cone_cosine <= 1.0f &&
                   base::isRange(p.first_chain, p.chain_count, set.patch_chains.size());
          })) {
    return "its patches are broken";
  }
  if (!followEachOther(
          set.parts, [](const SurfacePart& p) { return p.first_patch; },
          [](const SurfacePart& p) { return p.patch_count; }, set.patches.size(),
          [](const SurfacePart&) { return true; }) ||
      set.cluster_bounds.size() != set.clusters.size() || set.patch_bounds.size() != set.patches.size() ||
      set.part_bounds.size() != set.parts.size()) {
    return "its parts are broken";
  }
  if (!base::areRowStarts(set.first_adjoining, set.parts.size(), set.adjoining.size()) ||
      !allBelow(set.adjoining, set.clusters.size())) {
    return "its lists of adjoining clusters are broken";
  }
  if (!base::areRowStarts(set.first_of_object, objects, set.of_object.size()) ||
      !allBelow(set.of_object, set.parts.size()) || set.sizes_of_object.size() != set.of_object.size() ||
      set.object_bounds.size() != objects ||
      !all(set.objects, [objects](ObjectId id) { return id.value < objects; }) ||
      !std::is_sorted(set.objects.begin(), set.objects.end())) {
    return "its lists of objects are broken";
  }
  if (!all(set.uses, [&](const ChainUse& use) { return use.cluster < set.clusters.size(); }) ||
      !allBelow(set.cluster_chains, set.chains.size()) ||
      !all(set.patch_chains, [&](const PatchChain& c) { return c.chain < set.chains.size(); })) {
    return "its chains are broken";
  }
  if (!all(set.patch_chains, [](const PatchChain& c) { return isSmall(c.value); })) {
    return "its edges count for more than they can";
  }
  return !isFiniteSet(set) ? "some of its numbers are not finite" : flawOfChains(set);
}

}  // namespace

LargeVector<std::byte> surfaceBytes(const SurfaceSet& set) {
  return base::arrayBytes(kSurfacesHead, [&](auto&& visit) { forEachSurfaceArray(set, visit); });
}

Result<SurfaceSet> surfacesFrom(const SharedBytes& bytes, std::uint32_t object_count) {
  SurfaceSet set;
  if (const Status read = base::readArrays(bytes, kSurfacesHead, "surfaces",
                                           [&](auto&& visit) { forEachSurfaceArray(set, visit); });
      !read) {
    return read.error();
  }
  if (const std::string flaw = flawOf(set, object_count); !flaw.empty()) {
    return base::unsoundArrays("surfaces", flaw);
  }
  for (const Box& box : set.part_bounds) {
    set.bounds.extend(box);
  }
  return set;
}

}  // namespace sightline
