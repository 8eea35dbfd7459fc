#include "sightline/scene/check_scene.h"

#include <cstddef>
#include <cstdint>
#include <string>

#include "src/math/point_text.h"

namespace sightline {
namespace {

// What is wrong with the numbers of the object itself; empty if nothing is.
std::string faultOfNumbers(const SceneView& scene, const Object& object) {
  const std::uint64_t end = std::uint64_t{object.first_index} + object.index_count;
  if (end > scene.indices.size()) {
    return "first_index + index_count is " + std::to_string(end) + ", but the scene has " +
           std::to_string(scene.indices.size()) + " indices";
  }
  if (object.index_count % 3 != 0) {
    return "index_count is " + std::to_string(object.index_count) + "; it must be a multiple of 3";
  }
  if (!object.material.valid()) {
    return "it has no material; set Object::material";
  }
  if (object.material.value >= scene.materials.size()) {
    return "its material is " + std::to_string(object.material.value) + ", but the scene has " +
           std::to_string(scene.materials.size()) + " materials";
  }
  return {};
}

// What is wrong with its vertices, of an object whose own numbers are right; empty if nothing is.
std::string faultOfVertices(const SceneView& scene, const Object& object) {
  // What is not finite comes first: updateBounds() leaves no box around it.
  std::string outside;
  for (std::size_t i = object.first_index; i < std::size_t{object.first_index} + object.index_count; ++i) {
    const std::uint32_t index = scene.indices[i];
    if (index >= scene.positions.size()) {
      return "indices[" + std::to_string(i) + "] is " + std::to_string(index) + ", but the scene has " +
             std::to_string(scene.positions.size()) + " positions";
    }
    const Vec3f& position = scene.positions[index];
    if (!isFinite(position)) {
      return "position " + std::to_string(index) + " is not finite: " + math::textOf(position);
    }
    if (outside.empty() && !contains(object.bounds, Box{position, position})) {
      outside = "its bounds do not hold position " + std::to_string(index) + ", " + math::textOf(position) +
                "; updateBounds() makes them";
    }
  }
  return outside;
}

}  // namespace

Status checkScene(const SceneView& scene) {
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const Object& object = scene.objects[i];
    std::string fault = faultOfNumbers(scene, object);
    if (fault.empty()) {
      fault = faultOfVertices(scene, object);
    }
    if (!fault.empty()) {
      return Error{"object " + std::to_string(i) + ": " + fault};
    }
  }
  return Success{};
}

}  // namespace sightline
