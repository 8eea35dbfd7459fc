// Looks up what may be seen from a place in a baked file, and culls a frame with it.
// Create a file with: sightline bake SCENE -o F.sight

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "sightline/culling/culler.h"
#include "sightline/culling/visibility_octree_method.h"
#include "sightline/pvs/query/set_query.h"

using namespace sightline;

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fputs("usage: look_up_sets F.sight X Y Z\n", stderr);
    return 2;
  }
  // Once per scene. An engine also checks that the file is of its scene:
  // file->matches(sceneId(scene.view())).
  const Result<SightFile> file = SightFile::open(argv[1]);
  if (!file) {
    std::fprintf(stderr, "%s\n", file.error().message.c_str());
    return 2;
  }
  SetQuery query(*file);

  // Every frame. The near plane of this view clips nothing that is farther than nearDistance.
  View view;
  view.eye = {std::atof(argv[2]), std::atof(argv[3]), std::atof(argv[4])};
  setOrientation(view, /*forward=*/{0, 0, -1}, /*up_hint=*/{0, 1, 0});
  const VisibleSet set = query.find(view.eye, nearDistance(view));
  const BoxTreeView boxes = query.boxes();
  std::size_t objects = 0;
  for (const std::uint32_t node : set.nodes) {
    objects += boxes.objectsBelow(node).size();
  }
  std::printf("%zu of %zu objects may be seen from there\n", objects, boxes.objects.size());

  // Alternatively, let a Culler query the sets. It needs the boxes of the objects: here the baked ones.
  std::vector<Box> bounds(boxes.objects.size());
  for (std::uint32_t node = 0; node < boxes.nodes.size(); ++node) {
    if (boxes.leaf(node)) {
      bounds[boxes.objectsBelow(node)[0].value] = boxes.nodes[node].bounds;
    }
  }
  Culler culler({.object_bounds = bounds, .sets = &query}, visibilityOctree());
  culler.cull(view);
  std::printf("%zu of them in this view\n", culler.visible().size());
}
