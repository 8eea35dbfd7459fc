#include <atomic>

#include "sightline/occluders/surface_set.h"

namespace sightline {

SurfaceSetNumber::SurfaceSetNumber() {
  static std::atomic<std::uint64_t> last = 0;
  value_ = ++last;
}

}  // namespace sightline
