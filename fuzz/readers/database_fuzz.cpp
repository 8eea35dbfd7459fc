// Feeds bytes to the readers of occluder databases: by cells of space, as OccluderDatabase has them, and at
// grid points, as ViewpointDatabase does. The first byte says which, the second one how many occluders the
// scene has.

#include "fuzz/readers/fuzz_input.h"
#include "src/comparison/occluders/grid_points.h"
#include "src/occluders/database/database_cells.h"
#include "src/occluders/database/direction_lists.h"

using namespace sightline;
using namespace sightline::fuzz;

namespace {

using Cells = occluders::DirectionLists<occluders::CellTree>;
using Grid = occluders::DirectionLists<comparison::GridPoints>;

std::uint32_t placeOf(const occluders::CellTree& cells, const Vec3d& point) {
  return cells.cellOf(point);
}
std::uint32_t placeOf(const comparison::GridPoints& grid, const Vec3d& point) {
  return grid.nearest(point);
}

template <typename Lists>
void read(std::span<const std::byte> bytes, std::uint32_t occluders) {
  const Result<std::shared_ptr<const Lists>> lists = occluders::loadLists<Lists>(bytes, occluders);
  if (!lists) {
    requireOneLine(lists.error());
    return;
  }
  if (*lists == nullptr) {
    return;  // a database without lists
  }
  for (const Vec3d& point : {Vec3d(0, 0, 0), Vec3d(-3, 7, 20), Vec3d(1e300, -1e300, 0)}) {
    const std::uint32_t place = placeOf((*lists)->places, point);
    require(place < (*lists)->places.count());
    for (const OccluderId occluder : (*lists)->list(place, (*lists)->directions.nearest({0, 0, -1}))) {
      require(occluder.value < occluders);
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view text = textOf(data, size);
  const bool cells = takeByte(text) % 2 == 0;
  const std::uint32_t occluders = takeByte(text);
  cells ? read<Cells>(bytesOf(text), occluders) : read<Grid>(bytesOf(text), occluders);
  return 0;
}
