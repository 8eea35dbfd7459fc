// Feeds bytes to the glTF reader, which must return a valid scene or an error, whatever they are.
//
// Bytes that start with "glTF" or '{' and have no zero byte are used unchanged. Others are JSON, a zero byte,
// and the binary chunk, from which a .glb file is assembled; otherwise every change of length would fail at
// the container's header.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "src/io/gltf/gltf.h"

namespace {

using namespace sightline;
using namespace sightline::io;

void appendUint32(std::string& bytes, std::size_t value) {
  for (int shift = 0; shift < 32; shift += 8) {
    bytes.push_back(static_cast<char>(value >> shift & 0xff));
  }
}

std::string makeGlb(std::string json, std::string binary) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  binary.resize((binary.size() + 3) / 4 * 4, '\0');
  std::string bytes = "glTF";
  appendUint32(bytes, 2);
  appendUint32(bytes, 28 + json.size() + binary.size());
  appendUint32(bytes, json.size());
  bytes += "JSON" + json;
  appendUint32(bytes, binary.size());
  bytes += std::string("BIN\0", 4) + binary;
  return bytes;
}

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

void checkScene(const Scene& scene) {
  require(scene.objects.size() == scene.object_names.size());
  std::size_t next_index = 0;
  for (const Object& object : scene.objects) {
    require(object.first_index == next_index && object.index_count > 0 && object.index_count % 3 == 0);
    require(object.material.value < scene.materials.size());
    require(object.bounds.wellFormed());
    next_index += object.index_count;
  }
  require(next_index == scene.indices.size());
  for (const std::uint32_t index : scene.indices) {
    require(index < scene.positions.size());
  }
  for (const Vec3f& position : scene.positions) {
    require(isFinite(position));
  }
  for (const CameraPath& path : scene.paths) {
    require(!path.frames.empty() && path.z_near > 0.0 && path.z_far > path.z_near && path.width > 0 &&
            path.height > 0);
    for (const CameraFrame& frame : path.frames) {
      require(isFinite(frame.eye) && std::abs(length(frame.forward) - 1.0) < 1e-3);
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const ImportLimits limits{.triangles = 100'000,
                            .vertices = 200'000,
                            .objects = 10'000,
                            .name_bytes = 1 << 20,
                            .elements = 1 << 12,
                            .implied_elements = 1 << 16,
                            .sparse_elements = 1 << 16,
                            .camera_work = 10'000};
  std::string bytes(reinterpret_cast<const char*>(data), size);
  const std::size_t zero = bytes.find('\0');
  if (bytes.compare(0, 4, "glTF") != 0 && zero != std::string::npos) {
    bytes = makeGlb(bytes.substr(0, zero), bytes.substr(zero + 1));
  }
  const Result<Scene> scene = importGltf(bytes, "", "fuzz.glb", limits);
  if (scene) {
    checkScene(*scene);
  } else {
    require(!scene.error().message.empty() && scene.error().message.find('\n') == std::string::npos);
  }
  return 0;
}
