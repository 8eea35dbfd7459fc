#include "src/io/scene_bytes.h"

#include <algorithm>
#include <string>
#include <string_view>

#include "src/base/byte_stream.h"

namespace sightline::io {
namespace {

using base::ByteReader;
using base::ByteWriter;

constexpr std::size_t kNumberBytes = 4;

void addText(ByteWriter& writer, std::string_view text) {
  writer.add(static_cast<std::uint64_t>(text.size()));
  writer.addBytes(std::as_bytes(std::span(text)));
}

std::string readText(ByteReader& reader) {
  const std::span<const std::byte> bytes = reader.readBytes(reader.readCount<std::uint64_t>(1));
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void addMaterial(ByteWriter& writer, const Material& material) {
  addText(writer, material.name);
  writer.add(static_cast<std::uint8_t>(material.opacity));
  writer.add(static_cast<std::uint8_t>(material.double_sided ? 1 : 0));
  writer.addAll(std::span<const float>(material.base_color));
}

std::optional<Material> readMaterial(ByteReader& reader) {
  Material material;
  material.name = readText(reader);
  const auto opacity = reader.read<std::uint8_t>();
  material.double_sided = reader.read<std::uint8_t>() != 0;
  for (float& channel : material.base_color) {
    channel = reader.read<float>();
  }
  if (opacity > static_cast<std::uint8_t>(Opacity::kAlphaTested)) {
    return {};
  }
  material.opacity = static_cast<Opacity>(opacity);
  return material;
}

void addObject(ByteWriter& writer, const Object& object, std::string_view name) {
  writer.add(object.index_count);
  writer.add(object.material.value);
  writer.add(static_cast<std::uint8_t>(object.mark));
  addText(writer, name);
}

std::optional<Object> readObject(ByteReader& reader, const Scene& scene, std::uint64_t first_index) {
  Object object;
  object.first_index = static_cast<std::uint32_t>(first_index);
  object.index_count = reader.read<std::uint32_t>();
  object.material = MaterialId(reader.read<std::uint32_t>());
  const auto mark = reader.read<std::uint8_t>();
  if (object.index_count == 0 || object.index_count % 3 != 0 ||
      first_index + object.index_count > scene.indices.size() ||
      object.material.value >= scene.materials.size() ||
      mark > static_cast<std::uint8_t>(OccluderMark::kNever)) {
    return {};
  }
  object.mark = static_cast<OccluderMark>(mark);
  return object;
}

bool readMesh(ByteReader& reader, Scene& scene) {
  for (int axis = 0; axis < 3; ++axis) {
    scene.origin[axis] = reader.read<double>();
  }
  const auto numbers = reader.readAll<float>(3 * reader.readCount<std::uint64_t>(3 * kNumberBytes));
  for (std::size_t i = 0; i + 2 < numbers.size(); i += 3) {
    scene.positions.push_back({numbers[i], numbers[i + 1], numbers[i + 2]});
  }
  scene.indices = reader.readAll<std::uint32_t>(reader.readCount<std::uint64_t>(kNumberBytes));
  const std::size_t vertices = scene.positions.size();
  return isFinite(scene.origin) &&
         std::all_of(scene.positions.begin(), scene.positions.end(),
                     [](const Vec3f& position) { return isFinite(position); }) &&
         std::all_of(scene.indices.begin(), scene.indices.end(),
                     [vertices](std::uint32_t index) { return index < vertices; });
}

}  // namespace

std::vector<std::byte> sceneBytes(const Scene& scene) {
  ByteWriter writer;
  writer.reserve(12 * scene.positions.size() + 4 * scene.indices.size() + 64 * scene.objects.size());
  for (int axis = 0; axis < 3; ++axis) {
    writer.add(scene.origin[axis]);
  }
  writer.add(static_cast<std::uint64_t>(scene.positions.size()));
  for (const Vec3f& position : scene.positions) {
    for (const float number : {position.x, position.y, position.z}) {
      writer.add(number);
    }
  }
  writer.add(static_cast<std::uint64_t>(scene.indices.size()));
  writer.addAll(std::span<const std::uint32_t>(scene.indices));
  writer.add(static_cast<std::uint64_t>(scene.materials.size()));
  for (const Material& material : scene.materials) {
    addMaterial(writer, material);
  }
  writer.add(static_cast<std::uint64_t>(scene.objects.size()));
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    addObject(writer, scene.objects[i], scene.object_names[i]);
  }
  return writer.take();
}

std::optional<Scene> sceneFromBytes(std::span<const std::byte> bytes) {
  ByteReader reader(bytes);
  Scene scene;
  if (!readMesh(reader, scene)) {
    return {};
  }
  for (auto count = reader.readCount<std::uint64_t>(1); count > 0; --count) {
    const std::optional<Material> material = readMaterial(reader);
    if (!material) {
      return {};
    }
    scene.materials.push_back(*material);
  }
  std::uint64_t next_index = 0;
  for (auto count = reader.readCount<std::uint64_t>(1); count > 0; --count) {
    const std::optional<Object> object = readObject(reader, scene, next_index);
    if (!object) {
      return {};
    }
    next_index += object->index_count;
    scene.objects.push_back(*object);
    scene.object_names.push_back(readText(reader));
  }
  if (!reader.atEnd() || next_index != scene.indices.size()) {
    return {};
  }
  updateBounds(scene);
  return scene;
}

}  // namespace sightline::io
