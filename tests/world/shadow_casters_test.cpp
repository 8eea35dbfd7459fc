// Shadow casters: rays say which instance a shadow comes from, and it must be among them.

#include "sightline/world/shadow_casters.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/rounds.h"
#include "tests/world/hard_story.h"
#include "tests/world/rays.h"

namespace sightline {
namespace {

using namespace world_story;

View lightFrom(const Vec3d& eye, const Vec3d& forward, bool sun) {
  View light = viewFrom(eye, forward);
  light.orthographic = sun;
  light.ortho_height = 60.0;
  light.aspect = 1.0;
  light.tan_half_fovy = 1.5;
  light.z_near = 0.5;
  light.z_far = 200.0;
  return light;
}

// Whether the light's map shows this point, and the ray from the light to it.
struct LightRay {
  Vec3d from, along;
  double near = 0.0, length = 0.0;
};
std::optional<LightRay> rayTo(const View& light, const Vec3d& point) {
  const Vec3d at = point - light.eye;
  const double x = dot(light.right, at), y = dot(light.up, at), depth = dot(light.forward, at);
  if (depth <= light.z_near || depth >= light.z_far) {
    return std::nullopt;
  }
  const double half = light.orthographic ? 0.5 * light.ortho_height : light.tan_half_fovy * depth;
  if (std::abs(x) > half || std::abs(y) > half) {
    return std::nullopt;
  }
  if (light.orthographic) {
    return LightRay{point - light.forward * depth, light.forward, light.z_near, depth};
  }
  const double far = length(at);
  return LightRay{light.eye, at / far, light.z_near * far / depth, far};
}

struct Shadows {
  std::size_t shadowed = 0;
  std::string missing;
};

Shadows shadowsMissing(const ToldScene& story, const View& view, const View& light,
                       const ShadowCasters& casters) {
  const Rays rays(story);
  Shadows shadows;
  constexpr int kWidth = 32, kHeight = 18;
  for (int pixel = 0; pixel < kWidth * kHeight; ++pixel) {
    const double x = 2.0 * (pixel % kWidth + 0.5) / kWidth - 1.0,
                 y = 2.0 * (pixel / kWidth + 0.5) / kHeight - 1.0;
    const Vec3d along = normalized(view.forward + view.right * (x * view.tan_half_fovy * view.aspect) +
                                   view.up * (y * view.tan_half_fovy));
    const double slant = dot(along, view.forward);
    const auto seen = Rays::first(rays.hits(view.eye, along, view.z_near / slant, view.z_far / slant));
    const auto ray = seen ? rayTo(light, view.eye + along * seen->distance) : std::nullopt;
    if (!ray) {
      continue;
    }
    const std::vector<Hit> before = rays.hits(ray->from, ray->along, ray->near, ray->length - 1e-6);
    const auto blocker = Rays::first(before);
    for (const Hit& hit : before) {
      // The nearest opaque one, and what is blended before it.
      if (blocker && hit.distance > blocker->distance) {
        continue;
      }
      ++shadows.shadowed;
      if (!std::binary_search(casters.casters().begin(), casters.casters().end(), hit.id)) {
        shadows.missing += "a shadow of instance " + std::to_string(hit.id.value) + "; ";
      }
      EXPECT_EQ(casters.casterBits()[hit.id.value / 64] >> (hit.id.value % 64) & 1, 1u);
    }
  }
  return shadows;
}

// The world is changed in every way, near its zero and far from it.
TEST(ShadowCasters, EveryShadowHasItsCasterHoweverTheWorldIsChanged) {
  // seen, kept: by the light; where some instances have no place, all of these are kept.
  std::size_t shadowed = 0, seen = 0, kept = 0, all_seen = 0, all_kept = 0;
  for (std::uint32_t seed = 0; seed < test::rounds(12u); ++seed) {
    HardStory story(seed, seed % 2 == 0 ? Vec3d() : Vec3d(20000, 0, -8000), seed % 4 != 0);
    story.world.setOrigin(story.base);
    WorldCuller culler;
    ShadowCasters casters({.mask_pixels = seed % 5 < 2 ? 32u : 128u});
    const bool sun = seed % 3 != 0;
    const View light = lightFrom(sun ? Vec3d(30, 40, 10) : Vec3d(2, 14, 3),
                                 sun ? Vec3d(-3, -4, -1) : Vec3d(0.1, -1, 0.2), sun);
    for (int frame = 0; frame < 12; ++frame) {
      View view = story.next();
      view.z_far = frame % 4 == 0 ? std::numeric_limits<double>::infinity() : 30.0;
      culler.cull(story.world, story.inWorld(view));
      casters.cull(story.world, story.inWorld(light), culler);
      const Shadows shadows = shadowsMissing(story.drawn(~0u), view, light, casters);
      EXPECT_EQ(shadows.missing, "") << seed << " " << frame;
      shadowed += shadows.shadowed;
      all_seen += casters.stats().seen_by_light;
      all_kept += casters.casters().size();
      if (story.all_placed) {
        seen += casters.stats().seen_by_light;
        kept += casters.casters().size();
      }
    }
  }
  EXPECT_GT(shadowed, test::rounds(2000u));
  EXPECT_LT(2 * kept, seen);
  EXPECT_LT(all_kept, all_seen);
}

// A crate far behind the camera, with the sun behind it, too high for its shadow to reach the view; and one
// whose shadow falls before the camera.
TEST(ShadowCasters, WhatThrowsItsShadowElsewhereIsLeftOut) {
  Story story(allShapes());
  const InstanceId floor = story.add(3, boxAt({-64, -1, -64}, {128, 1, 128})),
                   near = story.add(0, boxAt({0, 6, 2}, {1, 1, 1})),
                   far = story.add(0, boxAt({0, 6, 40}, {1, 1, 1})),
                   below = story.add(0, boxAt({0, -20, -10}, {1, 1, 1}));
  const View view = viewFrom({0, 1.5, 0}, {0, 0, -1});
  const View light = lightFrom({0, 40, 40}, {0, -1, -1}, true);
  WorldCuller culler;
  ShadowCasters casters;
  for (int frame = 0; frame < 2; ++frame) {
    culler.cull(story.world, view);
    casters.cull(story.world, light, culler);
  }
  EXPECT_EQ(std::vector(casters.casters().begin(), casters.casters().end()), (std::vector{floor, near}));
  EXPECT_GT(casters.stats().before_nothing + casters.stats().beside_view, 0u);
  EXPECT_FALSE(std::binary_search(casters.light().visible().begin(), casters.light().visible().end(), below));
  EXPECT_TRUE(std::binary_search(casters.light().visible().begin(), casters.light().visible().end(), far));
}

TEST(ShadowCasters, AFaultyViewOrLightKeepsWhatTheOtherSees) {
  Story story(allShapes());
  const InstanceId crate = story.add(0, Mat4());
  View view = viewFrom({0, 1.5, 5}, {0, 0, -1});
  View light = lightFrom({0, 40, 40}, {0, -1, -1}, true);
  WorldCuller culler;
  ShadowCasters casters;
  view.aspect = std::numeric_limits<double>::quiet_NaN();
  culler.cull(story.world, view);
  casters.cull(story.world, light, culler);
  EXPECT_EQ(casters.casters().size(), 1u);
  view.aspect = 1.0;
  light.eye.x = std::numeric_limits<double>::infinity();
  culler.cull(story.world, view);
  casters.cull(story.world, light, culler);
  EXPECT_EQ(casters.casters().size(), 1u);
  // What was removed since the camera's cull is no receiver that anybody asks for.
  story.remove(crate);
  casters.cull(story.world, lightFrom({0, 40, 40}, {0, -1, -1}, true), culler);
  EXPECT_TRUE(casters.casters().empty());
}

// The light's axes are off by what validate() allows, so its rays are not quite along `forward`: nine
// kilometres below, the shadow of a crate 4 mm beside the view reaches 4 mm into it.
TEST(ShadowCasters, RaysOfTheSunAreThoseOfItsMap) {
  Story story(allShapes());
  const InstanceId ground = story.add(0, boxAt({-10, -9001, -5}, {20, 1, 10})),
                   crate = story.add(0, boxAt({0.004, -1, -1}, {1, 1, 2}));
  View view = viewFrom({-5, -9000, 50}, {0, 0, -1});
  view.orthographic = true;
  view.ortho_height = 20.0;
  view.aspect = 0.5;  // x from -10 to 0
  view.z_near = 1.0;
  view.z_far = 100.0;
  View light = lightFrom({0, 10, 0}, {0, -1, 0}, true);
  light.ortho_height = 100.0;
  light.z_near = 1.0;
  light.z_far = 9100.0;
  for (const double skew : {0.0, 9e-7}) {
    light.right = {1, -skew, 0};
    light.up = {0, 0, -1};
    ASSERT_TRUE(validate(light));
    WorldCuller culler;
    ShadowCasters casters;
    culler.cull(story.world, view);
    casters.cull(story.world, light, culler);
    EXPECT_TRUE(keeps(culler, ground));
    const bool casts = std::ranges::binary_search(casters.casters(), crate);
    EXPECT_EQ(casts, skew != 0.0);
  }
}

}  // namespace
}  // namespace sightline
