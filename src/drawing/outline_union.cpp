#include "src/drawing/outline_union.h"

#include <algorithm>

#include "src/drawing/clipper_paths.h"
#include "src/drawing/sliver.h"

namespace sightline::drawing {
namespace {

constexpr int kCoarsest = 16;  // low bits that may be dropped where Clipper fails

// Unites the loops with their coordinates' lowest `bits` dropped. Clipper's sweep rarely fails where many
// edges cross within a grid cell.
bool unite(const std::vector<GridPath>& loops, int bits, ClipperLib::Paths& result) {
  return clipSafely([&] {
    ClipperLib::Clipper clipper;
    for (const GridPath& loop : loops) {
      clipper.AddPath(clipperPath(loop, bits), ClipperLib::ptSubject, true);
    }
    return clipper.Execute(ClipperLib::ctUnion, result, ClipperLib::pftNonZero, ClipperLib::pftNonZero);
  });
}

}  // namespace

bool isConvexRing(const GridPath& ring) {
  const std::size_t count = ring.size();
  if (count < 3) {
    return false;
  }
  // A ring that turns one way only goes around once if it goes down once and up once.
  int changes = 0;
  bool was_up = ring[0] > ring[count - 1];
  for (std::size_t i = 0; i < count; ++i) {
    const GridPoint& a = ring[i];
    const GridPoint& b = ring[(i + 1) % count];
    if (turnOf(a, b, ring[(i + 2) % count]) <= 0) {
      return false;
    }
    const bool is_up = b > a;
    changes += is_up != was_up ? 1 : 0;
    was_up = is_up;
  }
  return changes == 2;
}

void uniteLoops(std::vector<GridPath>& loops, double min_width) {
  const auto dropSlivers = [&] {
    std::erase_if(loops, [&](const GridPath& ring) { return isSliver(ring, min_width); });
  };
  if (loops.empty() || (loops.size() == 1 && isConvexRing(loops[0]))) {
    dropSlivers();
    return;
  }
  // If all attempts fail, the loops stay as they are.
  for (int bits = 0; bits <= kCoarsest; ++bits) {
    ClipperLib::Paths united;
    if (unite(loops, bits, united)) {
      loops.clear();
      for (const ClipperLib::Path& path : united) {
        loops.push_back(gridPath(path, bits));
      }
      break;
    }
  }
  dropSlivers();
}

}  // namespace sightline::drawing
