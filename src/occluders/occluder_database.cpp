// Based on: Coorg, Teller. Real-Time Occlusion Culling for Models with Large Occluders. I3D 1997, section 5.
// Differs from the paper in: cells are made coarser than the kd-tree's leaves where memory is limited, the
// largest being refined first; scores hold for all viewpoints of a cell (see database_lists.cpp); directions
// are spread evenly (see sphere_directions.cpp).

#include "sightline/occluders/occluder_database.h"

#include <algorithm>
#include <mutex>
#include <numbers>
#include <unordered_map>
#include <vector>

#include "occluders/database_cells.h"
#include "occluders/database_lists.h"
#include "occluders/sphere_directions.h"

namespace sightline {

using namespace database_detail;

namespace {

// A range of Data::ids.
struct List {
  std::uint64_t first = 0;
  std::uint32_t length = 0;
};

}  // namespace

struct OccluderDatabase::Data {
  explicit Data(std::uint32_t direction_count) : directions(direction_count) {}

  SphereDirections directions;
  CellTree cells;
  std::vector<List> lists;  // by cell * directions + direction; equal ones may be in the same place
  std::vector<OccluderId> ids;

  std::size_t bytes() const {
    return sizeof(Data) + directions.bytes() + cells.bytes() + lists.capacity() * sizeof(List) +
           ids.capacity() * sizeof(OccluderId);
  }
};

namespace {

// Counts finished cells and passes their fraction on, one call at a time.
class CellProgress {
 public:
  CellProgress(const Progress& progress, std::uint32_t cells) : progress_(progress), cells_(cells) {}
  void cellDone() {
    if (progress_) {
      const std::lock_guard lock(mutex_);
      progress_(static_cast<double>(++done_) / cells_);
    }
  }

 private:
  const Progress& progress_;
  std::mutex mutex_;
  std::uint32_t cells_, done_ = 0;
};

std::uint64_t hashOf(std::span<const OccluderId> list) {  // FNV-1a
  std::uint64_t hash = 0xcbf29ce484222325ull;
  for (const OccluderId id : list) {
    hash = (hash ^ id.value) * 0x100000001b3ull;
  }
  return hash;
}

// Moves the lists, which lie in order, together in `ids`. Neighbouring directions and cells often agree: what
// is equal to an earlier list is dropped and refers to that one.
void pack(std::vector<OccluderId>& ids, std::vector<List>& lists) {
  const std::span<const OccluderId> all(ids);
  std::unordered_map<std::uint64_t, List> kept;  // by hash
  std::uint64_t end = 0;
  for (List& list : lists) {
    const std::span<const OccluderId> content = all.subspan(list.first, list.length);
    const auto [found, is_new] = kept.try_emplace(hashOf(content), List{end, list.length});
    const std::span<const OccluderId> earlier = all.subspan(found->second.first, found->second.length);
    if (!is_new && std::equal(content.begin(), content.end(), earlier.begin(), earlier.end())) {
      list = found->second;
      continue;
    }
    std::copy(content.begin(), content.end(), ids.begin() + static_cast<std::ptrdiff_t>(end));
    list.first = end;
    end += list.length;
  }
  ids.resize(end);
  ids.shrink_to_fit();
}

// So many cells fit when all lists are of full length and different; at least 1.
std::uint32_t cellLimit(std::size_t max_bytes, std::size_t bytes_without_cells, std::size_t directions,
                        std::size_t list_length) {
  const std::size_t a_cell = kBytesPerCell + directions * (list_length * sizeof(OccluderId) + sizeof(List));
  const std::size_t available = max_bytes > bytes_without_cells ? max_bytes - bytes_without_cells : 0;
  return static_cast<std::uint32_t>(std::clamp<std::size_t>(available / a_cell, 1, 1u << 30));
}

}  // namespace

OccluderDatabase OccluderDatabase::build(const Hierarchy& kd_tree, const OccluderSet& set,
                                         const OccluderDatabaseSettings& settings,
                                         const ParallelFor& parallel_for, const Progress& progress) {
  const auto data = std::make_shared<Data>(settings.directions);
  const CandidateTree candidates(set, settings.turned_away);
  const std::uint32_t directions = data->directions.count();
  const std::size_t length = std::min(settings.occluder_count, candidates.count());
  data->cells =
      buildCells(kd_tree, candidates.bounds(),
                 cellLimit(settings.max_bytes, sizeof(OccluderDatabase) + data->bytes(), directions, length));
  const std::uint32_t cells = data->cells.count();

  data->ids.resize(std::size_t{cells} * directions * length);
  data->lists.resize(std::size_t{cells} * directions);
  CellProgress cell_progress(progress, cells);
  parallel_for(cells, [&](std::uint32_t begin, std::uint32_t end) {
    ListFinder finder(
        candidates, data->directions,
        {static_cast<std::uint32_t>(length), settings.view_angle_deg, settings.area_angle_direction});
    std::vector<std::uint32_t> lengths(directions);
    for (std::uint32_t cell = begin; cell < end; ++cell) {
      const std::size_t first_list = std::size_t{cell} * directions;
      finder.find(data->cells.regions[cell],
                  std::span(data->ids).subspan(first_list * length, directions * length), lengths);
      for (std::size_t d = 0; d < directions; ++d) {
        data->lists[first_list + d] = {(first_list + d) * length, lengths[d]};
      }
      cell_progress.cellDone();
    }
  });
  pack(data->ids, data->lists);

  OccluderDatabase database;
  database.data_ = data;
  return database;
}

std::span<const OccluderId> OccluderDatabase::list(std::uint32_t cell, std::uint32_t direction) const {
  if (!data_) {
    return {};
  }
  const List& list = data_->lists[std::size_t{cell} * data_->directions.count() + direction];
  return std::span(data_->ids).subspan(list.first, list.length);
}

std::uint32_t OccluderDatabase::cellCount() const {
  return data_ ? data_->cells.count() : 1;
}

std::uint32_t OccluderDatabase::directionCount() const {
  return data_ ? data_->directions.count() : 1;
}

std::uint32_t OccluderDatabase::cellOf(const Vec3d& viewpoint) const {
  return data_ ? data_->cells.cellOf(viewpoint) : 0;
}

Box OccluderDatabase::cellRegion(std::uint32_t cell) const {
  return data_ ? data_->cells.regions[cell] : Box{{0, 0, 0}, {0, 0, 0}};
}

Vec3d OccluderDatabase::direction(std::uint32_t index) const {
  return data_ ? data_->directions[index] : Vec3d(1, 0, 0);
}

std::uint32_t OccluderDatabase::nearestDirection(const Vec3d& direction) const {
  return data_ ? data_->directions.nearest(direction) : 0;
}

double OccluderDatabase::coveringAngle() const {
  return data_ ? data_->directions.coveringAngle() : std::numbers::pi;
}

std::size_t OccluderDatabase::bytes() const {
  return sizeof(*this) + (data_ ? data_->bytes() : 0);
}

}  // namespace sightline
