// Feeds bytes to the reader of camera paths, which must return a path that can be walked or an error.

#include <vector>

#include "fuzz/readers/fuzz_input.h"
#include "sightline/io/camera_path_json.h"

using namespace sightline;
using namespace sightline::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<UnknownKey> unknown;
  const Result<CameraPath> path = parseCameraPath(textOf(data, size), "fuzz.json", &unknown);
  if (!path) {
    requireOneLine(path.error());
    return 0;
  }
  require(!path->frames.empty() && path->z_near > 0.0 && path->z_far > path->z_near && path->width > 0 &&
          path->height > 0);
  for (std::uint32_t frame = 0; frame < path->frames.size(); ++frame) {
    require(validate(path->view(frame, {})).has_value());
  }
  return 0;
}
