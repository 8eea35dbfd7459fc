// In which order must these be drawn? Two boxes one behind the other, and two that are stuck into each other.

#include <cstdio>
#include <vector>

#include "sightline/layers/layer_sorter.h"

using namespace sightline;

int main() {
  std::vector<Vec3d> corners;
  for (int i = 0; i < 8; ++i) {
    corners.emplace_back(i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0);
  }
  const Result<ConvexHull> box = buildHull(corners);
  if (!box) {
    std::fprintf(stderr, "%s\n", box.error().message.c_str());
    return 1;
  }

  // Once: hulls, and the parts that they stand for. Parts share hulls.
  LayerSorter sorter;
  const HullId hull = sorter.addHull(*box);
  std::vector<PartId> parts;
  for (int i = 0; i < 4; ++i) {
    parts.push_back(sorter.addPart({&hull, 1}));
  }

  // Every frame: where the parts are, then a view.
  const Vec3d places[] = {{0, 0, -20}, {0, 0, -10}, {8, 0, -15}, {9, 0.5, -15}};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    Mat4 world_from_part;
    world_from_part(0, 3) = places[i].x;
    world_from_part(1, 3) = places[i].y;
    world_from_part(2, 3) = places[i].z;
    sorter.setTransform(parts[i], world_from_part);
  }
  View view;
  setOrientation(view, /*forward=*/{0, 0, -1}, /*up_hint=*/{0, 1, 0});
  const LayerOrder& order = sorter.update(view);

  // Front to back; what shares a line cannot be ordered and must be drawn together.
  for (std::size_t i = 0; i < order.groups(); ++i) {
    for (const PartId part : order.group(i)) {
      std::printf("%u ", part.value);
    }
    std::printf("\n");
  }
}
