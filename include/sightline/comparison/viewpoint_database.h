#pragma once

// The occluder database by viewpoints: for points of a grid and for every viewing direction, the occluders
// that are best from there, chosen from pictures. Built once a scene.

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

// The user's preference: of sets with gain g (objects of culling that it hides), n occluders, and images that
// cover together a times the picture, the one with the largest g^gain / (count n + area a) is best. Negative
// and not finite: 0.
struct MinimumSetWeights {
  double gain = 1.0;
  double count = 1.0;
  double area = 1.0;
};

// Out of range: the nearest value that is in range.
struct ViewpointDatabaseSettings {
  OccluderCriterion criterion = OccluderCriterion::kMinimumSets;
  double spacing = 0.0;                // metres between grid points; 0: chosen
  std::uint32_t max_points = 256;      // 1 to 65,536; the spacing is enlarged until there are no more
  std::uint32_t directions = 32;       // spread evenly on the sphere, 1 to 4096
  std::uint32_t occluder_count = 512;  // of a list at most, up to 65,536
  std::uint32_t resolution = 128;      // pixels along the edge of a picture, 8 to 512
  double view_angle_deg = 100.0;       // of a picture, from border to border, 1 to 170
  // An occludee is a node with at most max_triangles below it, whose parent has more, or a leaf with more;
  // without those that have min_triangles or fewer.
  std::uint32_t min_triangles = 20, max_triangles = 256;
  double min_occluder_pixels = 2.0;  // smaller images are left out; also those that cover no pixel's centre
  std::uint32_t sets_per_occludee = 4;  // the cheapest that are kept, 0 to 64
  std::uint32_t search_limit = 256;     // occluders tried in the search for one occludee's sets, up to 2^20
  MinimumSetWeights weights{};
};

// Does not change once it is built: any number of threads may ask it. Copies share one memory.
class ViewpointDatabase final : public OccluderLists {
 public:
  // One point, one direction, an empty list.
  ViewpointDatabase() = default;

  // Makes a list for each grid point and direction from a square perspective picture that is sampled at pixel
  // centres. Lists are a choice of good occluders and promise nothing: whoever uses them has to find out what
  // they hide.
  //
  // viewpoints (scene space): only the grid points nearest to these are made. The grid is level: in x and z
  // its origin is the first viewpoint; its heights are those of viewpoints, each one serving what is up to an
  // eighth of the spacing above it. So a point near a path at eye height is at eye height. A spacing of 0 is
  // the smallest one of extent / 1024 * sqrt(2)^n for which 48 points (or max_points) suffice, extent being
  // the larger diagonal of hierarchy and viewpoints: some tens of points for a walk of any length. Viewpoints
  // that are not finite, or farther than 1e12 metres from the origin, are passed over.
  // Without viewpoints: all points of a grid in the box of the hierarchy, centred in it; spacing 0 makes as
  // many as max_points allows. One point is always made. A point within a solid does no harm.
  //
  // hierarchy: the occludees of minimum sets; nothing of it is kept. The lists take 4 bytes an entry, equal
  // ones once, and 16 each. While it builds, equal lists lie apart: it takes up to 8 bytes for an entry of
  // any list, about 100 for each list, and for each range handed to a thread some pictures.
  // Where points times directions would be more than 2^22, fewer points are made. The result does not depend
  // on the threads. progress: one step a picture.
  // Source: Poon, Wang 1999, section 4.
  static ViewpointDatabase build(const Hierarchy& hierarchy, const OccluderSet& set,
                                 std::span<const Vec3d> viewpoints = {},
                                 const ViewpointDatabaseSettings& settings = {},
                                 const ParallelFor& parallel_for = serialFor, const Progress& progress = {});

  // The list for the grid point that is nearest to `viewpoint` (scene space) and the stored direction nearest
  // to `direction` (any length > 0). Best first: its first k are a good choice of k. Time: logarithmic in the
  // number of points, as a rule, and a table for the direction; allocates nothing. Any viewpoint has a list,
  // also one that is not finite. The list lives as long as a copy of the database.
  std::span<const OccluderId> find(const Vec3d& viewpoint, const Vec3d& direction) const override;
  bool inOrder() const override { return true; }

  // What find looks up. point < pointCount(), direction < directionCount().
  std::span<const OccluderId> list(std::uint32_t point, std::uint32_t direction) const;

  std::uint32_t pointCount() const;
  std::uint32_t directionCount() const;
  // Of equally near ones the first. For what is not finite: 0.
  std::uint32_t nearestPoint(const Vec3d& viewpoint) const;
  Vec3d point(std::uint32_t index) const;  // scene space
  // The one with the smallest angle, of equal ones the first. For zero and what is not finite: 0.
  std::uint32_t nearestDirection(const Vec3d& direction) const;
  Vec3d direction(std::uint32_t index) const;  // unit length
  double spacing() const;                      // of the grid, metres

  std::size_t bytes() const;  // of memory that the data takes, all of it

  // All of it as bytes, for baked files: little-endian, the same for equal databases.
  std::vector<std::byte> save() const;
  // What save() gave, checked so far that any bytes are safe. occluder_count: of the OccluderSet whose ids it
  // holds. An error says what is wrong with the bytes.
  static Result<ViewpointDatabase> load(std::span<const std::byte> bytes, std::uint32_t occluder_count);

 private:
  struct Data;
  std::shared_ptr<const Data> data_;  // null: default constructed
};

}  // namespace sightline
