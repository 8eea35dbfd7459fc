#pragma once

// Pictures of layers, scenes for them, and the triangles that rays through their pixels intersect.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "sightline/render/layer_renderer.h"
#include "tests/render/largest_difference.h"
#include "tests/render/test_scene.h"

namespace sightline {

inline constexpr std::uint32_t kWidth = 64, kHeight = 48;

class LayerTest : public RenderTest {
 protected:
  static LayerRenderer layersOf(const Scene& scene,
                                const LayerRendererOptions& options = {kWidth, kHeight, 1}) {
    Result<LayerRenderer> renderer = LayerRenderer::create(scene.view(), options);
    EXPECT_TRUE(renderer.has_value());
    return std::move(renderer.value());
  }
};

inline LayerImage drawn(LayerRenderer& renderer, const View& view, std::span<const ObjectId> objects,
                        const LayerDraw& how = {}) {
  LayerImage image;
  (void)renderer.draw(view, objects, how, image);
  return image;
}

inline View turnedView(bool orthographic) {
  View view = testView({2.5, 1.7, 9.0});
  setOrientation(view, {-0.25, -0.2, -1.0}, {0.1, 1.0, 0.0});
  view.orthographic = orthographic;
  view.ortho_height = 6.0;
  return view;
}

inline float uniform(std::mt19937& random, float lo, float hi) {
  return std::uniform_real_distribution<float>(lo, hi)(random);
}

// Boxes and walls of opaque and alpha-tested materials.
inline SceneMaker opaqueScene(std::uint32_t seed) {
  std::mt19937 random(seed);
  SceneMaker maker;
  maker.wall(-3.0, 3.0, kGreen);
  for (int i = 0; i < 12; ++i) {
    const Vec3f at(uniform(random, -3, 2), uniform(random, -2, 1), uniform(random, -2, 2));
    const Vec3f size(uniform(random, 0.2f, 1), uniform(random, 0.2f, 1), uniform(random, 0.2f, 1));
    maker.box(at, at + size,
              i % 4 == 0   ? kFoliage
              : i % 4 == 1 ? kRed
              : i % 4 == 2 ? kBlueBothSides
                           : kGreen);
  }
  return maker;
}

// A ray through the centre of a pixel. Its intersections are computed here, without OpenGL.
struct Ray {
  Vec3d origin, direction;  // direction is 1 along forward, so that the ray's parameter is the depth
};

inline Ray rayThrough(const View& view, const LensPoint& lens, std::uint32_t x, std::uint32_t y) {
  const double half = view.orthographic ? 0.5 * view.ortho_height : view.tan_half_fovy;
  const double right = (2.0 * (x + 0.5) / kWidth - 1.0) * half * view.aspect;
  const double up = (1.0 - 2.0 * (y + 0.5) / kHeight) * half;
  const Vec3d across = view.right * right + view.up * up;
  const Vec3d offset = view.right * lens.right + view.up * lens.up;
  const Vec3d start = view.eye + (view.orthographic ? across : Vec3d());
  const Vec3d in_focus =
      view.orthographic ? start + view.forward * lens.focus : start + (view.forward + across) * lens.focus;
  const Vec3d origin = start + offset;
  return {origin, (in_focus - origin) / lens.focus};
}

struct Hit {
  double depth = 0.0;
  bool front = true;
  double margin = 0.0;  // smallest barycentric coordinate; below 0 the ray misses the triangle
};

inline std::optional<Hit> meet(const Ray& ray, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d ab = b - a, ac = c - a;
  const double area = dot(ray.direction, cross(ab, ac));
  if (std::abs(area) < 1e-12) {
    return std::nullopt;
  }
  const Vec3d from = ray.origin - a;
  const Vec3d side = cross(from, ray.direction);
  const double u = -dot(ac, side) / area, v = dot(ab, side) / area;
  return Hit{-dot(from, cross(ab, ac)) / area, area < 0.0, std::min({u, v, 1.0 - u - v})};
}

struct Fragment {
  ObjectId object;
  double depth = 0.0;
};

struct Fragments {
  std::vector<Fragment> list;  // those that are drawn, nearest first
  bool sure = true;            // the ray is not near an edge or near equal depths
};

inline Fragments fragmentsOf(const Scene& scene, const View& view, const Ray& ray) {
  Fragments found;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const Material& material = scene.view().materialOf(scene.objects[i]);
    const std::span<const std::uint32_t> indices = scene.view().indicesOf(scene.objects[i]);
    for (std::size_t t = 0; t < indices.size(); t += 3) {
      const auto at = [&](std::size_t k) { return Vec3d(scene.positions[indices[t + k]]); };
      const std::optional<Hit> hit = meet(ray, at(0), at(1), at(2));
      if (!hit) {
        found.sure = false;
        continue;
      }
      const bool shown = hit->front || material.double_sided;
      if (!shown || hit->margin < -0.02 || hit->depth < view.z_near || hit->depth > view.z_far) {
        continue;
      }
      found.sure = found.sure && hit->margin > 0.02;
      if (hit->margin >= 0.0) {
        found.list.push_back({ObjectId(i), hit->depth});
      }
    }
  }
  std::sort(found.list.begin(), found.list.end(),
            [](const Fragment& a, const Fragment& b) { return a.depth < b.depth; });
  for (std::size_t i = 1; i < found.list.size(); ++i) {
    found.sure = found.sure && found.list[i].depth - found.list[i - 1].depth > 1e-4;
  }
  return found;
}

// Random triangles, one for each object, with any of the materials.
inline Scene triangles(std::uint32_t seed, int count, const std::vector<Material>& materials) {
  std::mt19937 random(seed);
  Scene scene;
  scene.materials = materials;
  for (int i = 0; i < count; ++i) {
    Object& object = scene.objects.emplace_back();
    object.first_index = static_cast<std::uint32_t>(scene.indices.size());
    object.index_count = 3;
    object.material = MaterialId(static_cast<std::size_t>(i) % materials.size());
    for (int k = 0; k < 3; ++k) {
      scene.indices.push_back(static_cast<std::uint32_t>(scene.positions.size()));
      scene.positions.push_back(
          {uniform(random, -3, 3), uniform(random, -2.5f, 2.5f), uniform(random, -3, 3)});
    }
  }
  updateBounds(scene);
  return scene;
}

}  // namespace sightline
