#pragma once

// The occluder database by viewpoints: for points of a grid and for every viewing direction, the occluders
// that are best from there, chosen from pictures. It is built once for a scene, and serves to compare the
// method of Poon and Wang (1999) with others.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sightline/base/parallel_for.h"
#include "sightline/base/progress.h"
#include "sightline/base/result.h"
#include "sightline/hierarchy/hierarchy.h"
#include "sightline/occluders/occluder_lists.h"
#include "sightline/occluders/occluder_set.h"

namespace sightline {

// What makes an occluder a good one.
enum class OccluderCriterion : std::uint8_t {
  kProjectedSize,  // the area of its image, whatever may lie before it
  kFirstHit,       // the pixels in which it is the nearest
  kMinimumSets,    // it is one of few that together hide much
};

// The user's preference among minimum sets. The best set has the largest g^gain / (count n + area a), where g
// is the number of occludees that it hides, n its number of occluders, and a the area of their images as a
// fraction of the picture. Weights that are negative or not finite count as 0.
struct MinimumSetWeights {
  double gain = 1.0;
  double count = 1.0;
  double area = 1.0;
};

// A value out of range is taken as the nearest one in range.
struct ViewpointDatabaseSettings {
  OccluderCriterion criterion = OccluderCriterion::kMinimumSets;
  double spacing = 0.0;                // metres between grid points; 0: chosen
  std::uint32_t max_points = 256;      // 1 to 65,536; the spacing is enlarged until there are no more
  std::uint32_t directions = 32;       // spread evenly on the sphere, 1 to 4096
  std::uint32_t occluder_count = 512;  // of a list at most, up to 65,536
  std::uint32_t resolution = 128;      // pixels along the edge of a picture, 8 to 512
  double view_angle_deg = 100.0;       // of a picture, from border to border, 1 to 170
  // An occludee is a node with at most max_triangles below it whose parent has more, or a leaf with more.
  // Nodes with min_triangles or fewer are none.
  std::uint32_t min_triangles = 20, max_triangles = 256;
  double min_occluder_pixels = 2.0;  // smaller images are left out; also those that cover no pixel's centre
  std::uint32_t sets_per_occludee = 4;  // the cheapest that are kept, 0 to 64
  std::uint32_t search_limit = 256;     // occluders tried in the search for one occludee's sets, up to 2^20
  MinimumSetWeights weights{};
  // Where the minimum sets end, the list goes on with the others that are seen from the grid point, by first
  // hit: they hide nothing more from there, but may beside it. Not in the paper.
  bool first_hit_after_sets = false;
};

// Lists of occluders for the points of a grid. Does not change once it is built, so that any number of
// threads may ask it at the same time. Copies share one memory.
class ViewpointDatabase final : public OccluderLists {
 public:
  // One point, one direction, an empty list.
  ViewpointDatabase() = default;

  // Makes a list for each grid point and direction, from a square perspective picture that is sampled at
  // pixel centres. A list is a choice of good occluders and promises nothing: its user has to find out what
  // they hide.
  //
  // viewpoints (scene space): only the grid points nearest to them are made. In x and z the origin of the
  // grid is the first viewpoint. Its heights are those of viewpoints, and each height serves the viewpoints
  // up to an eighth of the spacing above it; so a point near a path at eye height is at eye height. A spacing
  // of 0 means the smallest extent / 1024 * sqrt(2)^n for which 48 points (or max_points) suffice, where
  // extent is the larger of the diagonals of the hierarchy and of the viewpoints: some tens of points for a
  // path of any length. Viewpoints that are not finite, or farther than 1e12 metres from the origin, are
  // passed over. Without viewpoints the points fill the box of the hierarchy, centred in it, and a spacing of
  // 0 makes as many as max_points allows. There is always one point. A point within a solid does no harm.
  //
  // hierarchy: its nodes are the occludees of minimum sets; nothing of it is kept.
  // Memory: 4 bytes for an entry of a list, equal lists once, and 16 for each list. The build takes up to 8
  // bytes for an entry of any list, about 100 for each list, and some pictures for each range handed to a
  // thread. Where points times directions would be more than 2^22, fewer points are made. The result does not
  // depend on the threads. progress: one step for each picture. Source: Poon, Wang 1999, section 4.
  static ViewpointDatabase build(const Hierarchy& hierarchy, const OccluderSet& set,
                                 std::span<const Vec3d> viewpoints = {},
                                 const ViewpointDatabaseSettings& settings = {},
                                 const ParallelFor& parallel_for = serialFor, const Progress& progress = {});

  // The list of the grid point nearest to `viewpoint` and of the stored direction nearest to `direction`: see
  // OccluderLists. Its first k entries are a good choice of k. Takes time logarithmic in the number of
  // points, as a rule, then a table for the direction.
  std::span<const OccluderId> find(const Vec3d& viewpoint, const Vec3d& direction) const override;
  bool inOrder() const override { return true; }

  // The list that find() returns for a point and a direction. point < pointCount(), direction <
  // directionCount().
  std::span<const OccluderId> list(std::uint32_t point, std::uint32_t direction) const;

  std::uint32_t pointCount() const;
  std::uint32_t directionCount() const;
  // The grid point nearest to the viewpoint, of equally near ones the first; 0 for one that is not finite.
  std::uint32_t nearestPoint(const Vec3d& viewpoint) const;
  Vec3d point(std::uint32_t index) const;  // scene space
  // The stored direction with the smallest angle to this one, of equal ones the first; 0 for zero and for
  // what is not finite.
  std::uint32_t nearestDirection(const Vec3d& direction) const;
  Vec3d direction(std::uint32_t index) const;  // unit length
  double spacing() const;                      // of the grid, metres

  std::size_t bytes() const;  // of memory

  // The database as bytes, for baked files: little-endian, the same for equal databases.
  std::vector<std::byte> save() const;
  // Reads what save() returned; bytes of any other origin are safe, and an error says what is wrong with
  // them. occluder_count: of the OccluderSet whose ids the database holds.
  static Result<ViewpointDatabase> load(std::span<const std::byte> bytes, std::uint32_t occluder_count);

 private:
  struct Data;
  std::shared_ptr<const Data> data_;  // null: default constructed
};

}  // namespace sightline
