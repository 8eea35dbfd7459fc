// Positions are grouped by a hash, so that each group is looked through alone. Numbers are given in the order
// in which the triangles use positions first: so that what lies together in the scene does so in the result.

#include "src/occluders/surfaces/weld_vertices.h"

#include <atomic>
#include <bit>
#include <tuple>

#include "src/base/hash_slots.h"
#include "src/base/parallel_rows.h"

namespace sightline::occluders {
namespace {

constexpr std::size_t kOpaqueOfPart = 16384, kPositionsOfPart = 65536;
constexpr std::size_t kPositionsOfRow = 4;  // on average
constexpr std::uint32_t kUnusedPosition = 0xffffffffu;

// Where and when a position is used.
struct Hashed {
  std::uint32_t hash = 0, position = 0;
};

// Adding zero turns -0 into +0, so that equal coordinates have equal bits.
Vec3f withoutMinus(const Vec3f& p) {
  return {p.x + 0.0f, p.y + 0.0f, p.z + 0.0f};
}

std::uint64_t hashOf(const Vec3f& position) {
  const Vec3f p = withoutMinus(position);
  const std::uint64_t xy =
      std::uint64_t{std::bit_cast<std::uint32_t>(p.x)} << 32 | std::bit_cast<std::uint32_t>(p.y);
  return base::mixBits(base::mixBits(xy) ^ std::bit_cast<std::uint32_t>(p.z));
}

// By position: the number of the first corner that uses it, or kUnusedPosition.
LargeVector<std::uint32_t> firstUses(const SceneView& scene, const OpaqueParts& triangles,
                                     const ParallelFor& parallel_for) {
  LargeVector<std::atomic<std::uint32_t>> first(scene.positions.size());
  base::forEach(parallel_for, first.size(),
                [&](std::uint32_t i) { first[i].store(kUnusedPosition, std::memory_order_relaxed); });
  triangles.run(parallel_for, [&](std::uint32_t part) {
    triangles.forEachTriangle(
        part, [&](std::uint32_t number, std::span<const std::uint32_t> corners, std::uint32_t) {
          for (std::uint32_t k = 0; k < 3; ++k) {
            std::atomic<std::uint32_t>& use = first[corners[k]];
            const std::uint32_t corner = 3 * number + k;
            std::uint32_t known = use.load(std::memory_order_relaxed);
            while (corner < known && !use.compare_exchange_weak(known, corner, std::memory_order_relaxed)) {
            }
          }
        });
  });
  LargeVector<std::uint32_t> found(first.size());
  base::forEach(parallel_for, first.size(),
                [&](std::uint32_t i) { found[i] = first[i].load(std::memory_order_relaxed); });
  return found;
}

// Sets to `of` those of equal positions the first use of which is not the first of all: of[position] becomes
// that one. items: of one hash row.
void joinEqual(std::span<const Vec3f> positions, std::span<const std::uint32_t> first_use,
               std::span<Hashed> row, std::span<std::uint32_t> of) {
  const auto place = [&](const Hashed& item) {
    const Vec3f p = withoutMinus(positions[item.position]);
    return std::tuple(p.x, p.y, p.z, first_use[item.position]);
  };
  std::sort(row.begin(), row.end(), [](const Hashed& a, const Hashed& b) { return a.hash < b.hash; });
  for (std::size_t i = 0, end = 0; i < row.size(); i = end) {
    while (end < row.size() && row[end].hash == row[i].hash) {
      ++end;
    }
    if (end - i == 1) {
      continue;
    }
    std::sort(row.begin() + static_cast<std::ptrdiff_t>(i), row.begin() + static_cast<std::ptrdiff_t>(end),
              [&](const Hashed& a, const Hashed& b) { return place(a) < place(b); });
    std::uint32_t kept = row[i].position;
    for (std::size_t k = i + 1; k < end; ++k) {
      kept = positions[row[k].position] == positions[kept] ? kept : row[k].position;
      of[row[k].position] = kept;
    }
  }
}

}  // namespace

OpaqueParts::OpaqueParts(const SceneView& scene) : scene_(scene), first_of_object_(1, 0) {
  first_of_object_.reserve(scene.objects.size() + 1);
  for (const Object& object : scene.objects) {
    const std::uint32_t count = mayOcclude(scene, object) ? object.triangleCount() : 0;
    first_of_object_.push_back(first_of_object_.back() + count);
  }
  parts_ = base::Parts(first_of_object_.back(), kOpaqueOfPart);
  all_finite_ = std::all_of(scene.positions.begin(), scene.positions.end(),
                            [](const Vec3f& position) { return isFinite(position); });
}

WeldedVertices weldVertices(const SceneView& scene, const OpaqueParts& triangles,
                            const ParallelFor& parallel_for) {
  const std::size_t count = scene.positions.size();
  const LargeVector<std::uint32_t> first_use = firstUses(scene, triangles, parallel_for);
  // By position: the one of those equal to it that is used first.
  LargeVector<std::uint32_t> kept = base::unsetVector<std::uint32_t>(count);
  base::forEach(parallel_for, count, [&](std::uint32_t i) { kept[i] = i; });
  {
    base::Rows<Hashed> by_hash;
    const int shift = 64 - static_cast<int>(std::bit_width(count / kPositionsOfRow + 1));
    base::groupIntoRows(
        parallel_for, std::size_t{1} << (64 - shift), count, by_hash.first(), by_hash.all(),
        [&](std::size_t begin, std::size_t end, auto&& pair) {
          for (std::size_t i = begin; i < end; ++i) {
            if (first_use[i] != kUnusedPosition) {
              const std::uint64_t hash = hashOf(scene.positions[i]);
              pair(hash >> shift, Hashed{static_cast<std::uint32_t>(hash), static_cast<std::uint32_t>(i)});
            }
          }
        });
    base::Parts(by_hash.count(), kPositionsOfPart)
        .run(parallel_for, [&](std::size_t, std::size_t begin, std::size_t end) {
          for (std::size_t row = begin; row < end; ++row) {
            joinEqual(scene.positions, first_use, by_hash[row], kept);
          }
        });
  }

  // The positions that get a number, by part of the triangles.
  std::vector<std::vector<std::uint32_t>> numbered(triangles.count());
  triangles.run(parallel_for, [&](std::uint32_t part) {
    triangles.forEachTriangle(
        part, [&](std::uint32_t number, std::span<const std::uint32_t> corners, std::uint32_t) {
          for (std::uint32_t k = 0; k < 3; ++k) {
            if (first_use[corners[k]] == 3 * number + k && kept[corners[k]] == corners[k]) {
              numbered[part].push_back(corners[k]);
            }
          }
        });
  });
  std::vector<std::uint32_t> first_number(1, 0);
  for (const std::vector<std::uint32_t>& part : numbered) {
    first_number.push_back(first_number.back() + static_cast<std::uint32_t>(part.size()));
  }
  WeldedVertices welded;
  welded.vertices = base::unsetVector<Vec3f>(first_number.back());
  welded.position_of = base::unsetVector<std::uint32_t>(first_number.back());
  welded.vertex_of.resize(count);
  triangles.run(parallel_for, [&](std::uint32_t part) {
    std::uint32_t number = first_number[part];
    for (const std::uint32_t position : numbered[part]) {
      welded.vertices[number] = withoutMinus(scene.positions[position]);
      welded.position_of[number] = position;
      welded.vertex_of[position] = number++;
    }
  });
  base::forEach(parallel_for, count, [&](std::uint32_t i) {
    if (kept[i] != i) {
      welded.vertex_of[i] = welded.vertex_of[kept[i]];
    }
  });
  return welded;
}

}  // namespace sightline::occluders
