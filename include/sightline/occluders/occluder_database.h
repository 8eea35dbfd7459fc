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

// Lists of occluders for the cells of a kd-tree. Does not change once it is built, so that any number of
// threads may ask it at the same time. Copies share one memory.
class OccluderDatabase final : public OccluderLists {
 public:
  // One cell, one direction, an empty list.
  OccluderDatabase() = default;

  // kd_tree: a hierarchy of kind kKdTree; nothing of it is kept. Cells are the regions of its nodes. Where
  // all lists of the leaves fit max_bytes at full length, each leaf is a cell; else the cell with the longest
  // diagonal is split first, until one more would not fit. There is always one cell, with the directions and
  // the k asked for, however small max_bytes is. A hierarchy of the other kind, or an empty one, is one cell.
  //
  // Memory: equal lists are stored once, so that bytes() may be far below max_bytes. The build takes up to
  // twice what all lists take at full length, about 50 bytes more for each list, and for each range of cells
  // handed to a thread the lists of one cell at full length.
  //
  // A list holds the k best occluders by a score, ties by id. The score is never smaller than the area-angle
  // at any viewpoint in the cell, for any viewing direction whose nearest stored one is the list's (both
  // capped at 2 pi). So no occluder is lost that is worth more somewhere in the cell than the score of the
  // last entry. Occluders are left out that no viewpoint of the cell sees from a side that hides, or within
  // half the view angle of such a direction; both are bounded (see
  // src/occluders/database/database_lists.cpp). This holds for perspective views from viewpoints in the box
  // of the tree, enlarged by 1/256 of its diagonal. Beyond it the lists of the outermost cells are found,
  // which are a good guess.
  //
  // The result does not depend on the threads. progress: one step a cell.
  // Source: Coorg, Teller 1997, section 5.
  static OccluderDatabase build(const Hierarchy& kd_tree, const OccluderSet& set,
                                const OccluderDatabaseSettings& settings = {},
                                const ParallelFor& parallel_for = serialFor, const Progress& progress = {});

  // The list of the viewpoint's cell and of the stored direction nearest to `direction`: see OccluderLists.
  // Takes one comparison for each level of the kd-tree, then a table for the direction.
  std::span<const OccluderId> find(const Vec3d& viewpoint, const Vec3d& direction) const override;
  bool inOrder() const override { return false; }

  // The list that find() returns for a cell and a direction. cell < cellCount(), direction <
  // directionCount().
  std::span<const OccluderId> list(std::uint32_t cell, std::uint32_t direction) const;

  std::uint32_t cellCount() const;
  std::uint32_t directionCount() const;
  // Every viewpoint is in exactly one cell; one in a split plane is on its upper side.
  std::uint32_t cellOf(const Vec3d& viewpoint) const;
  // The viewpoints that the cell's lists are made for. The outermost cells go on to infinity beyond their
  // box.
  Box cellRegion(std::uint32_t cell) const;
  // Unit length.
  Vec3d direction(std::uint32_t index) const;
  // The stored direction with the smallest angle to this one (any length > 0), of equal ones the first. For
  // zero and what is not finite: 0.
  std::uint32_t nearestDirection(const Vec3d& direction) const;
  // Bounds the angle between any direction and its nearest stored one, radians.
  double coveringAngleRad() const;

  std::size_t bytes() const;  // of memory

  // The database as bytes, for baked files: little-endian, the same for equal databases.
  std::vector<std::byte> save() const;
  // Reads what save() returned; bytes of any other origin are safe, and an error says what is wrong with
  // them. occluder_count: of the OccluderSet whose ids the database holds.
  static Result<OccluderDatabase> load(std::span<const std::byte> bytes, std::uint32_t occluder_count);

 private:
  struct Data;
  std::shared_ptr<const Data> data_;  // null: default constructed
};

}  // namespace sightline
