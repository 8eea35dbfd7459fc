// Based on: Coorg, Teller. Real-Time Occlusion Culling for Models with Large Occluders. I3D 1997, section 5.
// Differs from the paper in: cells are made coarser than the kd-tree's leaves where memory is limited, the
// largest being refined first; scores hold for all viewpoints of a cell (see database_lists.cpp); directions
// are spread evenly (see sphere_directions.cpp).

#include "sightline/occluders/occluder_database.h"

#include <algorithm>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "src/occluders/database/database_cells.h"
#include "src/occluders/database/database_lists.h"
#include "src/occluders/database/direction_lists.h"
#include "src/occluders/database/packed_lists.h"
#include "src/occluders/database/sphere_directions.h"
#include "src/occluders/step_progress.h"

namespace sightline {

using namespace occluders;

struct OccluderDatabase::Data : DirectionLists<CellTree> {
  using DirectionLists::DirectionLists;
};

namespace {

// So many cells fit when all lists are of full length and different; at least 1.
std::uint32_t cellLimit(std::size_t max_bytes, std::size_t bytes_without_cells, std::size_t directions,
                        std::size_t list_length) {
  const std::size_t a_list = list_length * sizeof(OccluderId) + PackedLists::bytesPerList();
  const std::size_t a_cell = kBytesPerCell + directions * a_list;
  const std::size_t available = max_bytes > bytes_without_cells ? max_bytes - bytes_without_cells : 0;
  return static_cast<std::uint32_t>(std::clamp<std::size_t>(available / a_cell, 1, kMaxCells));
}

// Returns the lists in rows, numbered cell * directions + direction.
PackedLists findLists(const CandidateTree& candidates, const SphereDirections& directions,
                      const CellTree& tree, const ListSettings& settings, const ParallelFor& parallel_for,
                      const Progress& progress) {
  const std::uint32_t cells = tree.count();
  const std::size_t lists_of_cell = directions.count(), ids_of_cell = lists_of_cell * settings.count;
  std::vector<OccluderId> ids(cells * ids_of_cell);  // each list with room for its full length
  std::vector<std::uint32_t> lengths(cells * lists_of_cell);
  StepProgress cell_progress(progress, cells);
  parallel_for(cells, [&](std::uint32_t begin, std::uint32_t end) {
    ListFinder finder(candidates, directions, settings);
    for (std::size_t cell = begin; cell < end; ++cell) {
      finder.find(tree.regions[cell], std::span(ids).subspan(cell * ids_of_cell, ids_of_cell),
                  std::span(lengths).subspan(cell * lists_of_cell, lists_of_cell));
      cell_progress.stepDone();
    }
  });

  ListPacker packer(lengths.size(), std::reduce(lengths.begin(), lengths.end(), std::size_t{0}));
  for (std::size_t list = 0; list < lengths.size(); ++list) {
    packer.add(std::span(ids).subspan(list * settings.count, lengths[list]));
  }
  ids = std::vector<OccluderId>();  // gives its memory back
  return packer.finish();
}

}  // namespace

OccluderDatabase OccluderDatabase::build(const Hierarchy& kd_tree, const OccluderSet& set,
                                         const OccluderDatabaseSettings& settings,
                                         const ParallelFor& parallel_for, const Progress& progress) {
  const auto data =
      std::make_shared<Data>(settings.directions, static_cast<std::uint32_t>(set.occluders.size()));
  const CandidateTree candidates(set, settings.turned_away);
  const std::uint32_t directions = data->directions.count();
  const std::size_t length = std::min(settings.occluder_count, candidates.count());
  data->places = buildCells(kd_tree, candidates.bounds(),
                            cellLimit(settings.max_bytes, sizeof(data) + data->bytes(), directions, length));
  data->lists =
      findLists(candidates, data->directions, data->places,
                {static_cast<std::uint32_t>(length), settings.view_angle_deg, settings.area_angle_direction},
                parallel_for, progress);

  OccluderDatabase database;
  database.data_ = data;
  return database;
}

std::span<const OccluderId> OccluderDatabase::find(const Vec3d& viewpoint, const Vec3d& direction) const {
  return list(cellOf(viewpoint), nearestDirection(direction));
}

std::span<const OccluderId> OccluderDatabase::list(std::uint32_t cell, std::uint32_t direction) const {
  if (!data_) {
    return {};
  }
  return data_->list(cell, direction);
}

std::uint32_t OccluderDatabase::cellCount() const {
  return data_ ? data_->places.count() : 1;
}

std::uint32_t OccluderDatabase::directionCount() const {
  return data_ ? data_->directions.count() : 1;
}

std::uint32_t OccluderDatabase::cellOf(const Vec3d& viewpoint) const {
  return data_ ? data_->places.cellOf(viewpoint) : 0;
}

Box OccluderDatabase::cellRegion(std::uint32_t cell) const {
  return data_ ? data_->places.regions[cell] : Box{{0, 0, 0}, {0, 0, 0}};
}

Vec3d OccluderDatabase::direction(std::uint32_t index) const {
  return data_ ? data_->directions[index] : Vec3d(1, 0, 0);
}

std::uint32_t OccluderDatabase::nearestDirection(const Vec3d& direction) const {
  return data_ ? data_->directions.nearest(direction) : 0;
}

double OccluderDatabase::coveringAngleRad() const {
  return data_ ? data_->directions.coveringAngleRad() : std::numbers::pi;
}

std::size_t OccluderDatabase::bytes() const {
  return sizeof(data_) + (data_ ? data_->bytes() : 0);
}

std::vector<std::byte> OccluderDatabase::save() const {
  return saveLists<CellTree>(data_.get());
}

Result<OccluderDatabase> OccluderDatabase::load(std::span<const std::byte> bytes,
                                                std::uint32_t occluder_count) {
  Result<std::shared_ptr<const Data>> data = loadLists<Data>(bytes, occluder_count);
  if (!data) {
    return data.error();
  }
  OccluderDatabase database;
  database.data_ = std::move(*data);
  return database;
}

}  // namespace sightline
