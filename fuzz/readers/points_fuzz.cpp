// Feeds bytes to the reader of points for `sightline query`.

#include "fuzz/readers/fuzz_input.h"
#include "tools/sightline/input/points_file.h"

using namespace sightline;
using namespace sightline::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Result<std::vector<Vec3d>> points = tool::parsePointsFile(textOf(data, size), "fuzz.json");
  if (!points) {
    require(!points.error().message.empty());
    return 0;
  }
  for (const Vec3d& point : *points) {
    require(isFinite(point));
  }
  return 0;
}
