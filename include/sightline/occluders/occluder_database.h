#pragma once

// The occluder database: for every cell of a scene and every viewing direction, the occluders that are best
// from there. Built once a scene; a look-up takes constant time.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sightline/base/parallel_for.h"
#include "sightline/base/progress.h"
#include "sightline/base/result.h"
#include "sightline/hierarchy/hierarchy.h"
#include "sightline/occluders/choose_occluders.h"
#include "sightline/occluders/occluder_lists.h"
#include "sightline/occluders/occluder_set.h"

namespace sightline {

struct OccluderDatabaseSettings {
  std::uint32_t directions = 32;       // spread evenly on the sphere, 1 to 4096
  std::uint32_t occluder_count = 512;  // k: the best for each cell and direction, at most
  std::size_t max_bytes = 64u << 20;   // of the database; cells are coarser where it would not fit
  double view_angle_deg = 100.0;       // full angle of the cone around a direction in which occluders count
  AreaAngleDirection area_angle_direction = AreaAngleDirection::kOccluder;
  // For look-ups from an object towards the eye (detail objects): single-sided occluders that turn their back
  // to the cell, since what hides the object faces the eye.
  bool turned_away = false;
};

// Does not change once it is built: any number of threads may ask it. Copies share one memory.
class OccluderDatabase final : public OccluderLists {
 public:
  // One cell, one direction, an empty list.
  OccluderDatabase() = default;

  // kd_tree: a hierarchy of kind kKdTree, of which nothing is kept. Cells are the regions of its nodes: of
  // its leaves if all their lists fit max_bytes at full length, else the largest cell (by its diagonal) is
  // split first until one more would not fit. One cell is always made, with the directions and the k asked
  // for, however small max_bytes is. A hierarchy of the other kind, or an empty one, is one cell. Equal lists
  // are stored once, so that bytes() may be far below max_bytes. While it builds it takes up to twice as
  // much as with all lists at full length, about 50 bytes more for each list, and for each range of cells
  // handed to a thread the lists of one cell at full length.
  //
  // A list holds exactly the k best occluders by a score that is never smaller than the area-angle at any
  // viewpoint in the cell, for any viewing direction whose nearest stored one is the list's, both capped at 2
  // pi: one that is worth more somewhere in the cell than the score of a full list's last entry is not lost.
  // Ties by id. Left out is what no viewpoint of the cell sees from a side that hides, or sees within half
  // the view angle of such a direction. (Both are bounded: see src/occluders/database_lists.cpp.) This holds
  // for perspective views and viewpoints in the box of the tree, enlarged by 1/256 of its diagonal; beyond
  // it, the lists of the outermost cells are found, as a good guess.
  //
  // The result does not depend on the threads. progress: one step a cell.
  // Source: Coorg, Teller 1997, section 5.
  static OccluderDatabase build(const Hierarchy& kd_tree, const OccluderSet& set,
                                const OccluderDatabaseSettings& settings = {},
                                const ParallelFor& parallel_for = serialFor, const Progress& progress = {});

  // The list for viewpoints near `viewpoint` (scene space) that look along `direction` (any length > 0), best
  // first. Time: a comparison for each level of the kd-tree, then a table for the direction; allocates
  // nothing. Any viewpoint has a list, also one that is not finite. The list lives as long as a copy of the
  // database.
  std::span<const OccluderId> find(const Vec3d& viewpoint, const Vec3d& direction) const override;
  bool inOrder() const override { return false; }

  // What find looks up. cell < cellCount(), direction < directionCount().
  std::span<const OccluderId> list(std::uint32_t cell, std::uint32_t direction) const;

  std::uint32_t cellCount() const;
  std::uint32_t directionCount() const;
  // Every viewpoint is in exactly one cell; one in a split plane is on its upper side.
  std::uint32_t cellOf(const Vec3d& viewpoint) const;
  // The viewpoints that the cell's lists are made for. Outermost cells go on beyond it, to infinity.
  Box cellRegion(std::uint32_t cell) const;
  // Unit length.
  Vec3d direction(std::uint32_t index) const;
  // The stored direction with the smallest angle to this one (any length > 0), of equal ones the first. For
  // zero and what is not finite: 0.
  std::uint32_t nearestDirection(const Vec3d& direction) const;
  // Bounds the angle between any direction and its nearest stored one, radians.
  double coveringAngle() const;

  std::size_t bytes() const;  // of memory that the data takes, all of it

  // All of it as bytes, for baked files: little-endian, the same for equal databases.
  std::vector<std::byte> save() const;
  // What save() gave, checked so far that any bytes are safe. occluder_count: of the OccluderSet whose ids it
  // holds. An error says what is wrong with the bytes.
  static Result<OccluderDatabase> load(std::span<const std::byte> bytes, std::uint32_t occluder_count);

 private:
  struct Data;
  std::shared_ptr<const Data> data_;  // null: default constructed
};

}  // namespace sightline
