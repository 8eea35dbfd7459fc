#pragma once

// Look-up in a baked file at run time: the viewpoint's cell, its side of the plane, its set.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "sightline/occlusion/visible_sets.h"
#include "sightline/pvs/query/sight_file.h"

namespace sightline {

struct SetQuerySettings {
  std::size_t cache_bytes = 16u << 20;  // memory of decoded sets; the last one is always kept
};

struct SetQueryStats {
  std::uint64_t finds = 0;
  std::uint64_t same_cell = 0;    // lookups in the same cell as the one before
  std::uint64_t decoded = 0;      // sets decoded
  std::uint64_t chunk_bytes = 0;  // bytes of the file's payload that were read for them
  // Lookups that returned all objects because the eye is in no cell, or where no viewer of its cell was
  // expected.
  std::uint64_t outside = 0;
  std::uint64_t beyond_near = 0;  // lookups that returned all objects because of their near distance
  std::uint64_t broken = 0;       // lookups that returned all objects because a chunk is corrupt
  std::size_t cached_bytes = 0;   // memory of the decoded sets
};

// The leaf and set of a viewpoint.
struct CellPlace {
  static constexpr std::uint32_t kOutside = 0xffffffffu;

  std::uint32_t leaf = kOutside;  // index into OctreeView::leaves
  // The set of the viewpoint's side, or VisibleSet::kEverything where no viewer was expected in the cell
  // (OctreeView::viewers); undefined outside.
  std::uint32_t set = 0;
  OctreeCell cell{};
};

// Looks up sets in a SightFile. For use by one thread at a time; several queries may share one file.
class SetQuery final : public VisibleSets {
 public:
  explicit SetQuery(SightFile file, const SetQuerySettings& settings = {});
  ~SetQuery() override;
  SetQuery(SetQuery&&) noexcept;
  SetQuery& operator=(SetQuery&&) noexcept;

  BoxTreeView boxes() const override;
  // Starts from the last leaf. A viewpoint on the border of cells is in the upper one. The cache evicts the
  // least recently used sets first.
  VisibleSet find(const Vec3d& eye, double near_distance) override;

  // Says which of the file's doors are closed, from the next find() on; at first all are open. Each counts as
  // open that is not named, and must be named only while it stands exactly where it was baked; one that is
  // ajar is open. Objects that are no doors are ignored. Does not allocate after warm-up.
  void setClosedDoors(std::span<const ObjectId> doors);

  // Finds the eye's leaf without its set. Outside means not in the box of the root, borders included, or not
  // finite. (If min + (max - min) rounds to another value than max, the smaller of the two is the upper
  // border.)
  CellPlace locate(const Vec3d& eye);

  const SetQueryStats& stats() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
