#pragma once

// Puts small glTF files together in memory, also wrong ones: the JSON may be changed at will before bytes()
// is called.

#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace sightline::test {

inline constexpr int kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123,
                     kUnsignedInt = 5125, kFloat = 5126;

template <typename T>
constexpr int componentTypeOf() {
  if constexpr (std::is_same_v<T, float>) {
    return kFloat;
  } else if constexpr (std::is_same_v<T, std::uint32_t>) {
    return kUnsignedInt;
  } else if constexpr (std::is_same_v<T, std::uint16_t>) {
    return kUnsignedShort;
  } else if constexpr (std::is_same_v<T, std::int16_t>) {
    return kShort;
  } else if constexpr (std::is_same_v<T, std::uint8_t>) {
    return kUnsignedByte;
  } else {
    static_assert(std::is_same_v<T, std::int8_t>);
    return kByte;
  }
}

class Glb {
 public:
  nlohmann::json json = {{"asset", {{"version", "2.0"}}},          {"scene", 0},
                         {"scenes", {{{"nodes", {0}}}}},           {"nodes", nlohmann::json::array()},
                         {"meshes", nlohmann::json::array()},      {"accessors", nlohmann::json::array()},
                         {"bufferViews", nlohmann::json::array()}, {"buffers", {{{"byteLength", 0}}}}};
  std::string binary;

  // Appends values, aligned, as a buffer view of their own. Returns its number.
  template <typename T>
  int addView(const std::vector<T>& values, int stride = 0) {
    binary.resize((binary.size() + 3) / 4 * 4, '\0');
    nlohmann::json view = {
        {"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", values.size() * sizeof(T)}};
    if (stride > 0) {
      view["byteStride"] = stride;
    }
    binary.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    json["bufferViews"].push_back(view);
    json["buffers"][0]["byteLength"] = binary.size();
    return static_cast<int>(json["bufferViews"].size()) - 1;
  }

  template <typename T>
  int addAccessor(const std::vector<T>& values, const char* type, std::size_t components) {
    json["accessors"].push_back({{"bufferView", addView(values)},
                                 {"componentType", componentTypeOf<T>()},
                                 {"count", values.size() / components},
                                 {"type", type}});
    return static_cast<int>(json["accessors"].size()) - 1;
  }
  int addPositions(const std::vector<float>& coordinates) { return addAccessor(coordinates, "VEC3", 3); }
  template <typename T>
  int addIndices(const std::vector<T>& indices) {
    return addAccessor(indices, "SCALAR", 1);
  }

  // Each primitive as JSON: {{"attributes", {{"POSITION", 0}}}}.
  int addMesh(std::initializer_list<nlohmann::json> primitives) {
    json["meshes"].push_back({{"primitives", nlohmann::json(primitives)}});
    return static_cast<int>(json["meshes"].size()) - 1;
  }
  static nlohmann::json primitive(int positions, int indices = -1, int mode = 4) {
    nlohmann::json primitive = {{"attributes", {{"POSITION", positions}}}, {"mode", mode}};
    if (indices >= 0) {
      primitive["indices"] = indices;
    }
    return primitive;
  }

  int addNode(nlohmann::json node) {
    json["nodes"].push_back(std::move(node));
    return static_cast<int>(json["nodes"].size()) - 1;
  }

  std::string bytes() const {
    std::string text = json.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string chunk = binary;
    chunk.resize((chunk.size() + 3) / 4 * 4, '\0');
    std::string glb = "glTF" + uint32(2) + uint32(28 + text.size() + chunk.size());
    glb += uint32(text.size()) + "JSON" + text;
    glb += uint32(chunk.size()) + std::string("BIN\0", 4) + chunk;
    return glb;
  }

  static std::string uint32(std::size_t value) {
    const auto narrow = static_cast<std::uint32_t>(value);
    std::string bytes(4, '\0');
    std::memcpy(bytes.data(), &narrow, 4);
    return bytes;
  }
};

// One node "triangle" with the triangle (0,0,0), (1,0,0), (0,1,0), which faces +Z, indexed by shorts.
inline Glb oneTriangle() {
  Glb glb;
  const int positions = glb.addPositions({0, 0, 0, 1, 0, 0, 0, 1, 0});
  const int indices = glb.addIndices<std::uint16_t>({0, 1, 2});
  glb.addNode({{"name", "triangle"}, {"mesh", glb.addMesh({Glb::primitive(positions, indices)})}});
  return glb;
}

}  // namespace sightline::test
