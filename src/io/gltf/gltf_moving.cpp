#include <charconv>
#include <string_view>

#include "src/io/gltf/gltf_model.h"

namespace sightline::io {
namespace {

// "/nodes/3/translation": the list, the number of its item, and what follows. False: it is something else.
struct Pointer {
  std::string_view list, property;
  std::size_t item = 0;
};
bool readPointer(std::string_view text, Pointer& pointer) {
  const std::size_t list_end = text.find('/', 1);
  if (!text.starts_with('/') || list_end == std::string_view::npos) {
    return false;
  }
  pointer.list = text.substr(1, list_end - 1);
  const char* const end = text.data() + text.size();
  const auto [rest, fault] = std::from_chars(text.data() + list_end + 1, end, pointer.item);
  if (fault != std::errc() || rest == end || *rest != '/') {
    return false;
  }
  pointer.property = std::string_view(rest + 1, static_cast<std::size_t>(end - rest - 1));
  return true;
}

void set(std::vector<bool>& flags, std::size_t item) {
  if (item < flags.size()) {
    flags[item] = true;
  }
}

void addPointer(const Pointer& pointer, Moving& moving) {
  const bool shape = pointer.property.starts_with("weights");
  if (pointer.list == "nodes" && shape) {
    set(moving.node_shapes, pointer.item);
  } else if (pointer.list == "nodes") {
    set(moving.nodes, pointer.item);
    if (pointer.property == "extensions/KHR_node_visibility/visible") {
      set(moving.visibility, pointer.item);
    }
  } else if (pointer.list == "meshes" && shape) {
    set(moving.mesh_shapes, pointer.item);
  } else if (pointer.list == "materials" && pointer.property.ends_with("ransmissionFactor")) {
    set(moving.materials, pointer.item);
  }
}

}  // namespace

Moving movingParts(const GltfFile& file) {
  Moving moving;
  moving.nodes.resize(file.nodes.size());
  moving.visibility.resize(file.nodes.size());
  moving.node_shapes.resize(file.nodes.size());
  moving.mesh_shapes.resize(file.meshes.size());
  moving.materials.resize(file.materials.size());
  for (std::size_t i = 0; i < file.nodes.size(); ++i) {
    moving.nodes[i] = file.nodes[i].exchanged;
  }
  for (const GltfFile::Animation& animation : file.animations) {
    for (const GltfFile::Channel& channel : animation.channels) {
      if (Pointer pointer; readPointer(channel.pointer, pointer)) {
        addPointer(pointer, moving);
      }
      if (channel.node >= 0) {
        set(channel.path == "weights" ? moving.node_shapes : moving.nodes,
            static_cast<std::size_t>(channel.node));
      }
    }
  }
  return moving;
}

}  // namespace sightline::io
