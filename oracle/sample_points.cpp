#include "oracle/sample_points.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "oracle/split_mix.h"
#include "src/scene/usable_view.h"

namespace sightline {
namespace {

constexpr double kInside = 1e-3;  // distance of samples from corners and edges, as a barycentric coordinate
constexpr int kTries = 4;         // attempts to find a triangle that shows its front

SplitMix generatorFor(ObjectId object, std::uint32_t sample, const Vec3d& eye) {
  SplitMix mix{(static_cast<std::uint64_t>(object.value) << 32) | sample};
  for (int axis = 0; axis < 3; ++axis) {
    mix.state ^= std::bit_cast<std::uint64_t>(eye[axis] + 0.0);
    mix.state = mix.next();
  }
  return mix;
}

Vec3d barycentric(std::uint32_t sample, SplitMix& random) {
  const double u = random.unit(), v = random.unit();
  double weights[3];
  switch (sample % 3) {
    case 0: {  // uniform on the face
      const double root = std::sqrt(u);
      return {1.0 - root, root * (1.0 - v), root * v};
    }
    case 1:
      weights[0] = 1.0 - 2.0 * kInside, weights[1] = kInside, weights[2] = kInside;
      break;
    default:
      weights[0] = kInside, weights[1] = (1.0 - kInside) * u, weights[2] = (1.0 - kInside) * (1.0 - u);
  }
  const int turn = std::min(2, static_cast<int>(v * 3.0));
  return {weights[turn], weights[(turn + 1) % 3], weights[(turn + 2) % 3]};
}

}  // namespace

SamplePoints::SamplePoints(const SceneView& scene) : scene_(scene), area_share_(scene.indices.size() / 3) {
  for (const Object& object : scene.objects) {
    const std::span<const std::uint32_t> indices = scene.indicesOf(object);
    const auto area = [&](std::size_t triangle) {
      const Vec3d a(scene.positions[indices[3 * triangle]]), b(scene.positions[indices[3 * triangle + 1]]),
          c(scene.positions[indices[3 * triangle + 2]]);
      const double twice = length(cross(b - a, c - a));
      return std::isfinite(twice) ? twice : 0.0;
    };
    double total = 0.0, sum = 0.0;
    for (std::uint32_t t = 0; t < object.triangleCount(); ++t) {
      total += area(t);
    }
    for (std::uint32_t t = 0; t < object.triangleCount(); ++t) {
      sum += area(t);
      area_share_[object.first_index / 3 + t] = static_cast<float>(total > 0.0 ? sum / total : 1.0);
    }
  }
}

std::uint32_t SamplePoints::triangleAt(const Object& object, double share) const {
  const auto first = area_share_.begin() + object.first_index / 3, last = first + object.triangleCount();
  const auto at = std::upper_bound(first, last, static_cast<float>(share));
  return static_cast<std::uint32_t>(std::min(at, last - 1) - first);
}

SamplePoints::Triangle SamplePoints::triangle(const Object& object, std::uint32_t index) const {
  const std::span<const std::uint32_t> corners = scene_.indicesOf(object).subspan(3 * std::size_t{index}, 3);
  return {Vec3d(scene_.positions[corners[0]]), Vec3d(scene_.positions[corners[1]]),
          Vec3d(scene_.positions[corners[2]])};
}

Vec3d SamplePoints::point(ObjectId id, std::uint32_t sample, const View& view) const {
  const Object& object = scene_.objects[id.value];
  SplitMix random = generatorFor(id, sample, view.eye);
  Triangle t;
  for (int attempt = 0; attempt < kTries; ++attempt) {
    t = triangle(object, triangleAt(object, random.unit()));
    const Vec3d direction = view.orthographic ? scene::sightDirection(view) : t.a - view.eye;
    if (scene_.materialOf(object).double_sided || dot(cross(t.b - t.a, t.c - t.a), direction) < 0.0) {
      break;
    }
  }
  const Vec3d weights = barycentric(sample, random);
  return t.a * weights.x + t.b * weights.y + t.c * weights.z;
}

Vec3d SamplePoints::besideEdge(ObjectId id, std::uint32_t sample, const View& view) const {
  const Object& object = scene_.objects[id.value];
  SplitMix random = generatorFor(id, ~sample, view.eye);
  const Triangle t = triangle(object, triangleAt(object, random.unit()));
  const Vec3d corners[3] = {t.a, t.b, t.c};
  const auto side = static_cast<std::size_t>(random.unit() * 3.0);
  const Vec3d from = corners[side], to = corners[(side + 1) % 3];
  const Vec3d point = from + (to - from) * random.unit();
  const Vec3d sight = view.orthographic ? scene::sightDirection(view) : point - view.eye;
  const double distance = view.orthographic ? 1.0 : length(sight);
  const double away = distance * std::pow(10.0, -2.0 - 5.0 * random.unit());
  return point + normalized(cross(to - from, sight)) * (random.unit() < 0.5 ? away : -away);
}

}  // namespace sightline
