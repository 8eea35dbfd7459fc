// Based on: Poon, Wang. Occlusion Culling Using Minimum Occluder Set and Opacity Map. IV 1999, section 4.
// Differs from the paper in: the grid points near known viewpoints can be made alone; directions are spread
// evenly on the sphere (see sphere_directions.cpp). The files minimum_sets.cpp, occluder_stack.cpp and
// set_selection.cpp say more.

#include "sightline/comparison/viewpoint_database.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "src/comparison/occluders/grid_points.h"
#include "src/comparison/occluders/viewpoint_lists.h"
#include "src/occluders/database_bytes.h"
#include "src/occluders/packed_lists.h"
#include "src/occluders/sphere_directions.h"
#include "src/occluders/step_progress.h"

namespace sightline {

using namespace comparison;
using namespace occluders;

namespace {

constexpr std::uint32_t kMaxPoints = 65536;
constexpr std::uint32_t kMaxLists = 1u << 22;
constexpr DatabaseKind kKind{"viewpoint database", "vptd"};

}  // namespace

struct ViewpointDatabase::Data {
  Data(std::uint32_t direction_count, std::uint32_t occluders, PointGrid made)
      : occluder_count(occluders), directions(direction_count), grid(std::move(made)), tree(grid.points) {}

  std::uint32_t occluder_count = 0;  // of the set
  SphereDirections directions;
  PointGrid grid;
  PointTree tree;
  PackedLists lists;  // by point * directions + direction

  std::size_t bytes() const {
    return sizeof(Data) + directions.bytes() + grid.points.capacity() * sizeof(Vec3d) + tree.bytes() +
           lists.bytes();
  }

  // An error lacks its subject.
  static Result<std::shared_ptr<const Data>> load(ByteReader& reader, std::uint32_t occluder_count);
};

namespace {

// NaN: the default.
double clampedOr(double value, double low, double high, double otherwise) {
  return std::isnan(value) ? otherwise : std::clamp(value, low, high);
}

double usableWeight(double weight) {
  return std::isfinite(weight) && weight > 0.0 ? std::min(weight, 1e6) : 0.0;
}

ViewpointDatabaseSettings inRange(ViewpointDatabaseSettings s) {
  const ViewpointDatabaseSettings defaults;
  s.directions = std::clamp(s.directions, 1u, occluders::kMaxDirections);
  s.max_points = std::clamp(s.max_points, 1u, std::min(kMaxPoints, kMaxLists / s.directions));
  s.occluder_count = std::min(s.occluder_count, 65536u);
  s.resolution = std::clamp(s.resolution, 8u, kMaxResolution);
  s.view_angle_deg = clampedOr(s.view_angle_deg, 1.0, 170.0, defaults.view_angle_deg);
  s.min_occluder_pixels = clampedOr(s.min_occluder_pixels, 0.0, 1e6, defaults.min_occluder_pixels);
  s.sets_per_occludee = std::min(s.sets_per_occludee, 64u);
  s.search_limit = std::min(s.search_limit, 1u << 20);
  s.weights = {usableWeight(s.weights.gain), usableWeight(s.weights.count), usableWeight(s.weights.area)};
  return s;
}

// Empties the lists.
PackedLists packed(std::vector<std::vector<OccluderId>>& lists) {
  std::size_t entries = 0;
  for (const std::vector<OccluderId>& list : lists) {
    entries += list.size();
  }
  ListPacker packer(lists.size(), entries);
  for (std::vector<OccluderId>& list : lists) {
    packer.add(list);
    list = std::vector<OccluderId>();  // gives its memory back
  }
  return packer.finish();
}

}  // namespace

ViewpointDatabase ViewpointDatabase::build(const Hierarchy& hierarchy, const OccluderSet& set,
                                           std::span<const Vec3d> viewpoints,
                                           const ViewpointDatabaseSettings& settings,
                                           const ParallelFor& parallel_for, const Progress& progress) {
  const PictureSource source(hierarchy, set, inRange(settings));
  const Box bounds = hierarchy.nodes.empty() ? Box{} : hierarchy.nodes[0].bounds;
  const auto data = std::make_shared<Data>(
      source.settings.directions, static_cast<std::uint32_t>(set.occluders.size()),
      makeGrid(bounds, viewpoints, source.settings.spacing, source.settings.max_points));
  const std::uint32_t directions = data->directions.count();
  const auto pictures = static_cast<std::uint32_t>(data->grid.points.size()) * directions;

  std::vector<std::vector<OccluderId>> made(pictures);
  StepProgress picture_progress(progress, pictures);
  parallel_for(pictures, [&](std::uint32_t begin, std::uint32_t end) {
    ListMaker maker(source);
    std::vector<OccluderId> list;
    for (std::uint32_t picture = begin; picture < end; ++picture) {
      if (picture == begin || picture % directions == 0) {
        maker.moveTo(data->grid.points[picture / directions]);
      }
      maker.make(data->directions[picture % directions], list);
      made[picture].assign(list.begin(), list.end());
      picture_progress.stepDone();
    }
  });
  data->lists = packed(made);

  ViewpointDatabase database;
  database.data_ = data;
  return database;
}

std::span<const OccluderId> ViewpointDatabase::find(const Vec3d& viewpoint, const Vec3d& direction) const {
  return list(nearestPoint(viewpoint), nearestDirection(direction));
}

std::span<const OccluderId> ViewpointDatabase::list(std::uint32_t point, std::uint32_t direction) const {
  if (!data_) {
    return {};
  }
  return data_->lists[std::size_t{point} * data_->directions.count() + direction];
}

std::uint32_t ViewpointDatabase::pointCount() const {
  return data_ ? static_cast<std::uint32_t>(data_->grid.points.size()) : 1;
}

std::uint32_t ViewpointDatabase::directionCount() const {
  return data_ ? data_->directions.count() : 1;
}

std::uint32_t ViewpointDatabase::nearestPoint(const Vec3d& viewpoint) const {
  return data_ ? data_->tree.nearest(viewpoint) : 0;
}

Vec3d ViewpointDatabase::point(std::uint32_t index) const {
  return data_ ? data_->grid.points[index] : Vec3d();
}

std::uint32_t ViewpointDatabase::nearestDirection(const Vec3d& direction) const {
  return data_ ? data_->directions.nearest(direction) : 0;
}

Vec3d ViewpointDatabase::direction(std::uint32_t index) const {
  return data_ ? data_->directions[index] : Vec3d(1, 0, 0);
}

double ViewpointDatabase::spacing() const {
  return data_ ? data_->grid.spacing : 0.0;
}

std::size_t ViewpointDatabase::bytes() const {
  return sizeof(data_) + (data_ ? data_->bytes() : 0);
}

std::vector<std::byte> ViewpointDatabase::save() const {
  ByteWriter writer;
  if (!data_) {
    addDatabaseHead(writer, kKind, {});
    return writer.take();
  }
  addDatabaseHead(writer, kKind, {data_->directions.count(), data_->occluder_count});
  writer.add(pointCount());
  saveGrid(writer, data_->grid);
  data_->lists.save(writer);
  return writer.take();
}

// Null: of a default-constructed database. Directions come last, because their tables take more memory than
// their number in the bytes justifies; the lists do.
Result<std::shared_ptr<const ViewpointDatabase::Data>> ViewpointDatabase::Data::load(
    ByteReader& reader, std::uint32_t occluder_count) {
  using Loaded = std::shared_ptr<const Data>;
  const Result<std::uint32_t> directions = readDatabaseHead(reader, kKind, occluder_count);
  if (!directions) {
    return directions.error();
  }
  if (*directions == 0) {
    return Loaded();
  }
  const auto points =
      reader.readCount<std::uint32_t>(std::size_t{*directions} * PackedLists::savedBytesPerList());
  if (points == 0 || points > std::min(kMaxPoints, kMaxLists / *directions)) {
    return Error{"has " + std::to_string(points) + " points"};
  }
  Result<PointGrid> grid = loadGrid(reader, points);
  if (!grid) {
    return grid.error();
  }
  Result<PackedLists> lists = PackedLists::load(reader, std::uint64_t{points} * *directions, occluder_count);
  if (!lists) {
    return lists.error();
  }
  const auto data = std::make_shared<Data>(*directions, occluder_count, std::move(*grid));
  data->lists = std::move(*lists);
  return Loaded(data);
}

Result<ViewpointDatabase> ViewpointDatabase::load(std::span<const std::byte> bytes,
                                                  std::uint32_t occluder_count) {
  ByteReader reader(bytes);
  Result<std::shared_ptr<const Data>> data = Data::load(reader, occluder_count);
  if (!data || !reader.atEnd()) {
    return databaseError(kKind, reader, data ? nullptr : &data.error());
  }
  ViewpointDatabase database;
  database.data_ = std::move(*data);
  return database;
}

}  // namespace sightline
