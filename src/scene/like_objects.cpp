#include "src/scene/like_objects.h"

#include <bit>
#include <cmath>

#include "src/base/hash_slots.h"
#include "src/base/sort_keys.h"

namespace sightline::scene {
namespace {

Vec3f cornerOf(const SceneView& scene, const Object& object, std::uint32_t corner) {
  return scene.positions[scene.indices[object.first_index + corner]] - object.bounds.min;
}

// A number that is the same for copies, but for those that rounding divides.
std::uint64_t keyOf(const SceneView& scene, const Object& object) {
  std::uint64_t key = object.index_count;
  const auto add = [&key](double number) { key = base::mixBits(key ^ std::bit_cast<std::uint64_t>(number)); };
  const Vec3f extent = object.bounds.extent();
  for (int axis = 0; axis < 3; ++axis) {
    int exponent = 0;
    add(std::floor(64.0 * std::frexp(extent[axis], &exponent)));
    add(exponent);
  }
  // Places are so coarse that rounding hardly ever makes a difference, and shifted so that it makes none at
  // the sides of the box, where many corners lie.
  constexpr double kPlaces = 32.0, kShift = 0.3;
  for (const std::uint32_t corner : {0u, object.index_count / 2}) {
    const Vec3f at = cornerOf(scene, object, corner) * (1.0f / maxComponent(extent));
    for (int axis = 0; axis < 3; ++axis) {
      add(std::floor(kPlaces * at[axis] + kShift));
    }
  }
  return key;
}

bool areAlike(const SceneView& scene, const Object& a, const Object& b) {
  const float most = kLikeness * maxComponent(a.bounds.extent());
  bool alike = a.index_count == b.index_count;
  for (std::uint32_t corner = 0; alike && corner < a.index_count; ++corner) {
    alike = maxComponent(abs(cornerOf(scene, a, corner) - cornerOf(scene, b, corner))) <= most;
  }
  return alike;
}

}  // namespace

std::vector<std::uint32_t> findLikeObjects(const SceneView& scene, const ParallelFor& parallel_for) {
  const auto count = static_cast<std::uint32_t>(scene.objects.size());
  std::vector<std::uint32_t> like(count);
  LargeVector<base::SortKey> keys(count);
  parallel_for(count, [&](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t i = begin; i < end; ++i) {
      const Object& object = scene.objects[i];
      const bool sized = object.bounds.wellFormed() && object.index_count > 0 &&
                         maxComponent(object.bounds.extent()) > 0.0f && isFinite(object.bounds.extent());
      keys[i] = {sized ? keyOf(scene, object) : i, i};
      like[i] = i;
    }
  });
  base::KeySorter().sort(keys, parallel_for);
  // More shapes with one key are not told apart: they count as shapes of their own.
  constexpr std::size_t kMostShapes = 8;
  std::vector<std::uint32_t> shapes;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (i > 0 && keys[i].first != keys[i - 1].first) {
      shapes.clear();
    }
    const auto object = static_cast<std::uint32_t>(keys[i].second);
    for (const std::uint32_t shape : shapes) {
      if (areAlike(scene, scene.objects[shape], scene.objects[object])) {
        like[object] = shape;
        break;
      }
    }
    if (like[object] == object && shapes.size() < kMostShapes) {
      shapes.push_back(object);
    }
  }
  return like;
}

}  // namespace sightline::scene
