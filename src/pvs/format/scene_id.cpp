#include "sightline/pvs/format/scene_id.h"

#include <array>

#include "src/pvs/format/checksum.h"

namespace sightline {

SceneId sceneId(const SceneView& scene) {
  pvs::Checksum hash;
  hash.addValue(std::uint64_t{scene.positions.size()});
  hash.add(std::as_bytes(scene.positions));
  hash.addValue(std::uint64_t{scene.indices.size()});
  hash.add(std::as_bytes(scene.indices));
  for (const Object& object : scene.objects) {
    const Material& material = scene.materialOf(object);
    hash.addValue(std::array<std::uint32_t, 5>{
        object.first_index, object.index_count, static_cast<std::uint32_t>(material.opacity),
        material.double_sided ? 1u : 0u, static_cast<std::uint32_t>(object.mark)});
    hash.add(std::as_bytes(std::span(&object.bounds, 1)));
  }
  return {hash.value(), scene.objects.size(), scene.indices.size() / 3};
}

std::uint64_t occluderSetHash(const OccluderSet& set) {
  pvs::Checksum hash;
  for (const Occluder& occluder : set.occluders) {
    hash.addValue(std::array<std::uint32_t, 3>{occluder.vertex_count, occluder.double_sided ? 1u : 0u,
                                               occluder.object.value});
    hash.add(std::as_bytes(set.verticesOf(occluder)));
    hash.add(std::as_bytes(std::span(&occluder.slack, 1)));
    hash.add(std::as_bytes(std::span(&occluder.plane, 1)));
  }
  hash.add(std::as_bytes(std::span(set.body_of)));
  for (const OccluderBody& body : set.bodies) {
    hash.add(std::as_bytes(set.verticesOf(body)));
    hash.add(std::as_bytes(set.edgesOf(body)));
    hash.add(std::as_bytes(std::span(&body.slack, 1)));
  }
  return hash.value();
}

}  // namespace sightline
