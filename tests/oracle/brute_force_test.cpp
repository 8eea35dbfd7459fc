// Compares Embree's results with a ray caster of twenty lines in double precision.

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

#include "oracle/exact_visibility.h"
#include "oracle/view_rays.h"
#include "tests/support/hand_made.h"

namespace sightline {
namespace {

using namespace hand_made;

Scene randomScene(std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(-12.0f, 12.0f), size(-4.0f, 4.0f);
  Scene scene;
  for (const Opacity opacity : {Opacity::kOpaque, Opacity::kOpaque, Opacity::kBlended}) {
    addMaterial(scene, opacity, false);
    addMaterial(scene, opacity, true);
  }
  for (int o = 0; o < 150; ++o) {
    std::vector<Vec3f> corners;
    const Vec3f centre(place(random), place(random), place(random) * 2.0f);
    for (int i = 0; i < 9; ++i) {
      corners.push_back(centre + Vec3f(size(random), size(random), size(random)));
    }
    addTriangles(scene, MaterialId(std::uint32_t(random() % scene.materials.size())), corners);
  }
  return scene;
}

// How clearly the ray passes inside (positive) or outside (negative) the triangle, and the position of the
// hit.
struct Crossing {
  double margin = -1.0, t = 0.0, slope = 0.0;
};

// Moeller, Trumbore: Fast, minimum storage ray-triangle intersection, 1997.
Crossing cross(const ViewRay& ray, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d e1 = b - a, e2 = c - a, p = cross(ray.direction, e2), s = ray.origin - a;
  const double determinant = dot(e1, p);
  if (determinant == 0.0) {
    return {};
  }
  const double u = dot(s, p) / determinant;
  const Vec3d q = cross(s, e1);
  const double v = dot(ray.direction, q) / determinant;
  return {std::min({u, v, 1.0 - u - v}), dot(e2, q) / determinant, determinant};
}

// Objects that a ray shows, or nothing if rounding could change the result.
std::optional<std::set<std::uint32_t>> seenAlong(const Scene& scene, const View& view, const ViewRay& ray) {
  constexpr double kClear = 1e-4;
  const double length = view.z_far - view.z_near;
  std::map<double, std::pair<std::uint32_t, bool>> hits;
  for (std::uint32_t o = 0; o < scene.objects.size(); ++o) {
    const Material& material = scene.materials[scene.objects[o].material.value];
    for (std::uint32_t i = 0; i < scene.objects[o].index_count; i += 3) {
      const Vec3f* corner = &scene.positions[scene.objects[o].first_index + i];
      const Crossing hit = cross(ray, Vec3d(corner[0]), Vec3d(corner[1]), Vec3d(corner[2]));
      if (hit.margin < -kClear || (!material.double_sided && hit.slope < 0.0)) {
        continue;
      }
      if (hit.margin < kClear || std::abs(hit.slope) < kClear || std::abs(hit.t) < kClear ||
          std::abs(hit.t - length) < kClear || hits.contains(hit.t)) {
        return std::nullopt;
      }
      if (hit.t > 0.0 && hit.t < length) {
        hits[hit.t] = {o, material.opaque()};
      }
    }
  }
  std::set<std::uint32_t> seen;
  for (const auto& [t, hit] : hits) {
    seen.insert(hit.first);
    if (hit.second) {
      break;
    }
  }
  return seen;
}

View randomView(std::mt19937& random) {
  std::uniform_real_distribution<double> place(-15.0, 15.0), unit(-1.0, 1.0), share(0.3, 1.5);
  View view;
  view.eye = {place(random), place(random), place(random)};
  setOrientation(view, {unit(random), unit(random), unit(random)},
                 {unit(random), unit(random), unit(random)});
  view.orthographic = random() % 3 == 0;
  view.tan_half_fovy = share(random);
  view.ortho_height = 20.0 * share(random);
  view.z_near = share(random);
  view.z_far = 20.0 * share(random) + 2.0;
  if (random() % 2 == 0) {
    view.shift_x = unit(random);
    view.shift_y = unit(random);
  }
  return view;
}

TEST(ExactVisibility, AgreesWithABruteForceRayCasterOnRandomTriangles) {
  std::size_t compared = 0, objects = 0;
  for (std::uint32_t seed = 1; seed <= 30; ++seed) {
    const Scene scene = randomScene(seed);
    const ExactVisibility oracle(scene.view());
    std::mt19937 random(1000 + seed);
    for (int i = 0; i < 100; ++i) {
      const View view = randomView(random);
      // One pixel: a ray in a random direction.
      const ViewRay ray = rayOfPixel(view, 0, 0, 1, 1);
      const std::optional<std::set<std::uint32_t>> expected = seenAlong(scene, view, ray);
      if (!expected) {
        continue;
      }
      std::set<std::uint32_t> found;
      for (const SeenPoint& witness : oracle.visibleThroughPixels(view, 1, 1)) {
        found.insert(witness.object.value);
        EXPECT_TRUE(oracle.confirm(view, witness)) << "seed " << seed << " view " << i;
      }
      EXPECT_EQ(found, *expected) << "seed " << seed << " view " << i;
      compared += 1;
      objects += found.size();
    }
  }
  EXPECT_GT(compared, 500u);
  EXPECT_GT(objects, 1000u);
}

// Objects that aimed rays report as visible are visible to the brute-force caster too.
TEST(ExactVisibility, AimedRaysClaimNothingThatBruteForceDenies) {
  std::size_t compared = 0;
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    const Scene scene = randomScene(seed);
    const ExactVisibility oracle(scene.view());
    std::mt19937 random(2000 + seed);
    std::vector<ObjectId> all;
    for (std::uint32_t o = 0; o < scene.objects.size(); ++o) {
      all.push_back(ObjectId(o));
    }
    for (int i = 0; i < 10; ++i) {
      const View view = randomView(random);
      for (const SeenPoint& witness : oracle.visibleByAimedRays(view, all, 24)) {
        const std::optional<std::set<std::uint32_t>> expected =
            seenAlong(scene, view, rayTo(view, witness.point));
        if (expected) {
          compared += 1;
          EXPECT_TRUE(expected->contains(witness.object.value)) << "seed " << seed << " view " << i;
          EXPECT_TRUE(oracle.confirm(view, witness)) << "seed " << seed << " view " << i;
        }
      }
    }
  }
  EXPECT_GT(compared, 500u);
}

// Aimed rays find nearly every object that pixels show, and more.
TEST(ExactVisibility, AimedRaysReachWhatPixelsSee) {
  const Scene scene = randomScene(99);
  const ExactVisibility oracle(scene.view());
  std::mt19937 random(7);
  std::size_t by_pixels = 0, by_both = 0;
  for (int i = 0; i < 10; ++i) {
    const View view = randomView(random);
    std::vector<ObjectId> seen;
    for (const SeenPoint& witness : oracle.visibleThroughPixels(view, 100, 100)) {
      seen.push_back(witness.object);
    }
    by_pixels += seen.size();
    by_both += oracle.visibleByAimedRays(view, seen, 64).size();
  }
  EXPECT_GT(by_pixels, 50u);
  EXPECT_GT(by_both * 10, by_pixels * 9);
}

}  // namespace
}  // namespace sightline
