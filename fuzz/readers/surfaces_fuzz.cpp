// Feeds bytes to the reader of prepared surfaces. The first byte is the number of the scene's objects.

#include "fuzz/readers/fuzz_input.h"
#include "sightline/occluders/surface_set.h"

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

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view text = textOf(data, size);
  const std::uint32_t objects = takeByte(text);
  const Result<SurfaceSet> set = surfacesFrom(bytesOf(text), objects);
  if (!set) {
    require(!set.error().message.empty());
    return 0;
  }
  readAll(*set, objects);
  return 0;
}
