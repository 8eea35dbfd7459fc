#pragma once

// Look-up in a baked file at run time: a viewpoint's cell, its side, its set.

#include <cstddef>
#include <cstdint>
#include <memory>

#include "sightline/occlusion/visible_sets.h"
#include "sightline/pvs/query/sight_file.h"

namespace sightline {

struct SetQuerySettings {
  std::size_t cache_bytes = 16u << 20;  // of decoded sets; the last one is always kept
};

struct SetQueryStats {
  std::uint64_t finds = 0;
  std::uint64_t same_cell = 0;    // in the cell of the find before
  std::uint64_t decoded = 0;      // sets that had to be decoded
  std::uint64_t outside = 0;      // answered "everything" for want of a cell
  std::uint64_t beyond_near = 0;  // answered "everything" because of their near distance
  std::uint64_t broken = 0;       // answered "everything" because a chunk was broken
  std::size_t cached_bytes = 0;   // storage of the decoded sets
};

// A viewpoint's place in the octree.
struct CellPlace {
  static constexpr std::uint32_t kOutside = 0xffffffffu;

  std::uint32_t leaf = kOutside;  // into OctreeView::leaves
  std::uint32_t set = 0;          // of its side; where it is outside: meaningless
  OctreeCell cell{};
};

// Used by one thread at a time; several may share one SightFile.
class SetQuery final : public VisibleSets {
 public:
  explicit SetQuery(SightFile file, const SetQuerySettings& settings = {});
  ~SetQuery() override;
  SetQuery(SetQuery&&) noexcept;
  SetQuery& operator=(SetQuery&&) noexcept;

  BoxTreeView boxes() const override;
  // Starts from the last leaf. A viewpoint on the border of cells is in the upper one. Least recently used
  // sets leave the cache first.
  VisibleSet find(const Vec3d& eye, double near_distance) override;

  // Where the eye is, without its set. Outside: not in the box of the root, borders included, or not finite.
  // (Where min + (max - min) is not max by rounding, the lesser of the two is the upper border.)
  CellPlace locate(const Vec3d& eye);

  const SetQueryStats& stats() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
