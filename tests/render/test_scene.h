#pragma once

// Small scenes made by hand, and a renderer for them if this machine has OpenGL.

#include <gtest/gtest.h>

#include <array>
#include <initializer_list>
#include <memory>
#include <utility>
#include <vector>

#include "sightline/render/renderer.h"
#include "tests/support/pictures.h"

namespace sightline {

inline constexpr std::uint32_t kRed = 0, kGreen = 1, kGlass = 2, kFoliage = 3, kBlueBothSides = 4;

class SceneMaker {
 public:
  SceneMaker() {
    scene.materials = {
        {.name = "red", .base_color = {0.8f, 0.05f, 0.05f, 1.0f}},
        {.name = "green", .base_color = {0.05f, 0.8f, 0.05f, 1.0f}},
        {.name = "glass", .opacity = Opacity::kBlended, .base_color = {0.1f, 0.1f, 0.9f, 0.5f}},
        {.name = "foliage",
         .opacity = Opacity::kAlphaTested,
         .double_sided = true,
         .base_color = {0.9f, 0.9f, 0.0f, 1.0f}},
        {.name = "blue", .double_sided = true, .base_color = {0.05f, 0.05f, 0.8f, 1.0f}}};
  }

  // Adds a rectangle at z whose front faces +z, or -z if turned.
  ObjectId wall(double z, double half, std::uint32_t material, bool turned = false) {
    const auto h = static_cast<float>(half);
    const auto d = static_cast<float>(z);
    begin(material);
    const auto base = static_cast<std::uint32_t>(scene.positions.size());
    scene.positions.insert(scene.positions.end(), {{-h, -h, d}, {h, -h, d}, {h, h, d}, {-h, h, d}});
    for (const std::uint32_t corner : turned ? std::array<std::uint32_t, 6>{0, 2, 1, 0, 3, 2}
                                             : std::array<std::uint32_t, 6>{0, 1, 2, 0, 2, 3}) {
      scene.indices.push_back(base + corner);
    }
    return end();
  }

  // Adds a box with its fronts outwards.
  ObjectId box(const Vec3f& lo, const Vec3f& hi, std::uint32_t material) {
    begin(material);
    const auto base = static_cast<std::uint32_t>(scene.positions.size());
    for (int i = 0; i < 8; ++i) {
      scene.positions.push_back({(i & 1) ? hi.x : lo.x, (i & 2) ? hi.y : lo.y, (i & 4) ? hi.z : lo.z});
    }
    for (const std::uint32_t corner : {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                                       2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6}) {
      scene.indices.push_back(base + corner);
    }
    return end();
  }

  Scene scene;

 private:
  void begin(std::uint32_t material) {
    Object& object = scene.objects.emplace_back();
    object.first_index = static_cast<std::uint32_t>(scene.indices.size());
    object.material = MaterialId(material);
  }
  ObjectId end() {
    Object& object = scene.objects.back();
    object.index_count = static_cast<std::uint32_t>(scene.indices.size()) - object.first_index;
    for (const std::uint32_t index : scene.view().indicesOf(object)) {
      object.bounds.extend(scene.positions[index]);
    }
    return ObjectId(scene.objects.size() - 1);
  }
};

// A red wall a centimetre before a green one.
inline Scene closeWalls(const Vec3f& at = {}) {
  SceneMaker maker;
  maker.wall(0.0, 1.0, kGreen);
  maker.wall(0.01, 1.0, kRed);
  for (Vec3f& position : maker.scene.positions) {
    position += at;
  }
  return std::move(maker.scene);
}

// A view from z = 10 along -z.
inline View testView(const Vec3d& eye = {0.0, 0.0, 10.0}) {
  View view;
  view.eye = eye;
  setOrientation(view, {0.0, 0.0, -1.0}, {0.0, 1.0, 0.0});
  view.tan_half_fovy = 0.5;
  view.aspect = 4.0 / 3.0;
  return view;
}

inline std::vector<ObjectId> allOf(const Scene& scene) {
  std::vector<ObjectId> ids;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    ids.push_back(ObjectId(i));
  }
  return ids;
}

struct Pixel {
  int r, g, b;
};
inline Pixel pixelOf(const Image& image, std::uint32_t x, std::uint32_t y) {
  const std::uint8_t* p = &image.rgba[4 * (std::size_t{y} * image.width + x)];
  return {p[0], p[1], p[2]};
}
inline Pixel middleOf(const Image& image) {
  return pixelOf(image, image.width / 2, image.height / 2);
}

inline bool isRed(const Pixel& p) {
  return p.r > 2 * p.g && p.r > 2 * p.b;
}
inline bool isGreen(const Pixel& p) {
  return p.g > 2 * p.r && p.g > 2 * p.b;
}
inline bool isBlue(const Pixel& p) {
  return p.b > 2 * p.r && p.b > 2 * p.g;
}

class RenderTest : public ::testing::Test {
 protected:
  void SetUp() override { SIGHTLINE_SKIP_WITHOUT_PICTURES(); }

  static Renderer rendererOf(const Scene& scene, std::uint32_t width = 320, std::uint32_t height = 240) {
    Result<Renderer> renderer = Renderer::create(scene.view(), width, height);
    EXPECT_TRUE(renderer.has_value());
    return std::move(renderer.value());
  }
};

}  // namespace sightline
