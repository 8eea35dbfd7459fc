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
#include "src/occluders/database/direction_lists.h"
#include "src/occluders/step_progress.h"

namespace sightline {

using namespace comparison;
using namespace occluders;

struct ViewpointDatabase::Data : DirectionLists<GridPoints> {
  using DirectionLists::DirectionLists;
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
  s.max_points = std::clamp(s.max_points, 1u, GridPoints::maxCount(s.directions));
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
      GridPoints(makeGrid(bounds, viewpoints, source.settings.spacing, source.settings.max_points)));
  const std::uint32_t directions = data->directions.count();
  const auto pictures = data->places.count() * directions;

  std::vector<std::vector<OccluderId>> made(pictures);
  StepProgress picture_progress(progress, pictures);
  parallel_for(pictures, [&](std::uint32_t begin, std::uint32_t end) {
    ListMaker maker(source);
    std::vector<OccluderId> list;
    for (std::uint32_t picture = begin; picture < end; ++picture) {
      if (picture == begin || picture % directions == 0) {
        maker.moveTo(data->places.points()[picture / directions]);
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
  return data_->list(point, direction);
}

std::uint32_t ViewpointDatabase::pointCount() const {
  return data_ ? data_->places.count() : 1;
}

std::uint32_t ViewpointDatabase::directionCount() const {
  return data_ ? data_->directions.count() : 1;
}

std::uint32_t ViewpointDatabase::nearestPoint(const Vec3d& viewpoint) const {
  return data_ ? data_->places.nearest(viewpoint) : 0;
}

Vec3d ViewpointDatabase::point(std::uint32_t index) const {
  return data_ ? data_->places.points()[index] : Vec3d();
}

std::uint32_t ViewpointDatabase::nearestDirection(const Vec3d& direction) const {
  return data_ ? data_->directions.nearest(direction) : 0;
}

Vec3d ViewpointDatabase::direction(std::uint32_t index) const {
  return data_ ? data_->directions[index] : Vec3d(1, 0, 0);
}

double ViewpointDatabase::spacing() const {
  return data_ ? data_->places.spacing() : 0.0;
}

std::size_t ViewpointDatabase::bytes() const {
  return sizeof(data_) + (data_ ? data_->bytes() : 0);
}

std::vector<std::byte> ViewpointDatabase::save() const {
  return saveLists<GridPoints>(data_.get());
}

Result<ViewpointDatabase> ViewpointDatabase::load(std::span<const std::byte> bytes,
                                                  std::uint32_t occluder_count) {
  Result<std::shared_ptr<const Data>> data = loadLists<Data>(bytes, occluder_count);
  if (!data) {
    return data.error();
  }
  ViewpointDatabase database;
  database.data_ = std::move(*data);
  return database;
}

}  // namespace sightline
