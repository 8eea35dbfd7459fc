// Feeds bytes to the readers of what is prepared once a scene: surfaces, occluders, hierarchies, objects'
// boxes. The first byte is the number of the scene's objects.

#include "fuzz/readers/fuzz_input.h"
#include "sightline/hierarchy/hierarchy.h"
#include "sightline/occluders/occluder_set.h"
#include "sightline/occluders/surface_set.h"
#include "sightline/scene/object_boxes.h"

using namespace sightline;
using namespace sightline::fuzz;

namespace {

// Reads all of it through the functions that drawing uses: a sanitizer detects reads beyond an array.
void readAll(const SurfaceSet& set, std::uint32_t objects) {
  std::size_t sum = 0;
  for (std::uint32_t object = 0; object < objects; ++object) {
    for (const std::uint32_t part : set.partsOf(ObjectId(object))) {
      require(part < set.parts.size());
    }
    sum += set.sizesOf(ObjectId(object)).size();
  }
  for (std::uint32_t part = 0; part < set.parts.size(); ++part) {
    for (const SurfacePatch& patch : set.patchesOf(set.parts[part])) {
      sum += set.chainsOf(patch).size();
    }
    for (const std::uint32_t cluster : set.adjoiningOf(part)) {
      require(cluster < set.clusters.size());
    }
  }
  for (const SurfaceCluster& cluster : set.clusters) {
    for (const std::uint32_t vertex : set.trianglesOf(cluster)) {
      require(vertex < set.vertices.size());
    }
    for (const std::uint32_t chain : set.chainsOf(cluster)) {
      require(chain < set.chains.size());
      sum += set.verticesOf(set.chains[chain]).size() + set.usesOf(set.chains[chain]).size();
    }
  }
  require(sum < (std::size_t{1} << 40));
}

void readAll(const OccluderSet& set, std::uint32_t objects) {
  std::size_t sum = 0;
  for (std::uint32_t i = 0; i < set.occluders.size(); ++i) {
    sum += set.verticesOf(set.occluders[i]).size();
    for (const OccluderEdge& edge : set.edgesOf(set.occluders[i])) {
      require(edge.line < set.lines.size());
      for (const EdgeNeighbour& neighbour : set.neighboursOf(edge)) {
        require(neighbour.occluder.value < set.occluders.size());
      }
    }
    if (const OccluderBody* body = set.bodyOf(OccluderId(i))) {
      for (const BodyEdge& edge : set.edgesOf(*body)) {
        require(edge.from < set.verticesOf(*body).size() && edge.left < set.facesOf(*body).size());
      }
    }
  }
  for (std::uint32_t object = 0; object < objects; ++object) {
    for (const OccluderId id : set.unitsOf(ObjectId(object))) {
      require(id.value < set.occluders.size());
    }
    sum += set.occludersOf(ObjectId(object)).size();
  }
  require(sum < (std::size_t{1} << 40));
}

void readAll(const Hierarchy& hierarchy, std::uint32_t objects) {
  for (std::uint32_t n = 0; n < hierarchy.nodes.size(); ++n) {
    const HierarchyNode& node = hierarchy.nodes[n];
    require(node.leaf() ? node.link < hierarchy.objects.size()
                        : hierarchy.end(hierarchy.right(NodeIndex(n))) == node.link);
  }
  for (const ObjectId object : hierarchy.objects) {
    require(object.value < objects);
  }
}

void readAll(const ObjectBoxes& boxes, std::uint32_t objects) {
  for (std::uint32_t object = 0; object < objects; ++object) {
    require(boxes.of(ObjectId(object)).size() <= kMaxObjectBoxes);
  }
}

template <typename Made>
void check(const Result<Made>& made, std::uint32_t objects) {
  if (made) {
    readAll(*made, objects);
  } else {
    require(!made.error().message.empty());
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view text = textOf(data, size);
  const std::uint32_t objects = takeByte(text);
  const auto bytes = bytesOf(text);
  check(surfacesFrom({bytes}, objects), objects);
  check(occludersFrom({bytes}, objects), objects);
  check(hierarchyFrom(bytes, objects), objects);
  check(objectBoxesFrom(bytes, objects), objects);
  return 0;
}
