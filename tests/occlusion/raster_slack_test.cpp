// Meshes whose shared edges and depths are off their merged polygons by the slack that findOccluders allows,
// seen so closely that the slack spans pixels: what shows through must not be called hidden.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sightline/occlusion/depth_pyramid.h"
#include "sightline/occlusion/opacity_map.h"
#include "tests/occlusion/small_scenes.h"

namespace sightline {
namespace {

Scene sceneOf(std::vector<Vec3f> positions, std::vector<std::uint32_t> indices) {
  Scene scene;
  scene.positions = std::move(positions);
  scene.indices = std::move(indices);
  scene.materials.push_back({});
  Object object;
  object.index_count = static_cast<std::uint32_t>(scene.indices.size());
  object.material = MaterialId{0u};
  scene.objects.push_back(object);
  updateBounds(scene);
  return scene;
}

using Wide = long double;

Wide determinant(const Wide* a, const Wide* b, const Wide* c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
         a[2] * (b[0] * c[1] - b[1] * c[0]);
}

// Whether no triangle beyond the near plane lies between the eye and the point; edges belong to triangles.
bool reaches(const Scene& scene, const View& view, const Vec3d& point) {
  const Wide eye[3] = {view.eye.x, view.eye.y, view.eye.z};
  const Wide ray[3] = {point.x - eye[0], point.y - eye[1], point.z - eye[2]};
  const Wide depth = view.forward.x * ray[0] + view.forward.y * ray[1] + view.forward.z * ray[2];
  for (std::size_t i = 0; i < scene.indices.size(); i += 3) {
    Wide q[3][3];
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f& p = scene.positions[scene.indices[i + k]];
      q[k][0] = p.x - eye[0];
      q[k][1] = p.y - eye[1];
      q[k][2] = p.z - eye[2];
    }
    const Wide a = determinant(ray, q[1], q[2]), b = determinant(ray, q[2], q[0]),
               c = determinant(ray, q[0], q[1]);
    const bool within = (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
    if (!within || a + b + c == 0) {
      continue;
    }
    const Wide t = determinant(q[0], q[1], q[2]) / (a + b + c);
    if (t > 0 && t < 1 && t * depth >= view.z_near) {
      return false;
    }
  }
  return true;
}

View viewOf(const Vec3d& eye, double tan_half, double near) {
  View view = test::viewFrom(eye, {0, 0, -1});
  view.tan_half_fovy = tan_half;
  view.z_near = near;
  view.z_far = 100;
  return view;
}

void expectSeen(const Scene& scene, const View& view, const Box& box, std::uint32_t size, const char* what) {
  ASSERT_TRUE(reaches(scene, view, center(box))) << what << ": the test's own premise";
  const OccluderSet set = findOccluders(scene.view(), {.area_fraction = 1.0});
  ASSERT_GE(set.occluders.size(), 1u);
  DepthPyramid pyramid({.raster = {.width = size, .height = size}});
  pyramid.build(view, set, test::all(set));
  EXPECT_NE(pyramid.classify(box), Visibility::kHidden) << what;
  OpacityMapSettings settings;
  settings.raster.width = settings.raster.height = size;
  OpacityMap map(settings);
  map.build(view, set, test::all(set));
  EXPECT_NE(map.classify(box), Visibility::kHidden) << what;
}

// A wall, and a second one that recedes steeply from its edge. The middle vertex of the edge is 10
// micrometres off the straight line, at a distance where that is a part of a pixel: there the receding wall
// is seen through the first one's polygon, deeper than it.
TEST(MapSlack, DepthOfAWallBeyondASharedEdgeThatIsNotStraight) {
  constexpr float kKink = 1e-5f, kAside = 1.0f / 15, kY = 32;
  const Scene scene = sceneOf({{.5f, kY - .5f, 0},
                               {0, kY - .5f, 0},
                               {kKink, kY, 0},
                               {0, kY + .5f, 0},
                               {.5f, kY + .5f, 0},
                               {-kAside, kY - .5f, -1},
                               {-kAside, kY + .5f, -1}},
                              {1, 0, 2, 0, 4, 2, 2, 4, 3, 5, 1, 2, 5, 2, 6, 2, 3, 6});
  const auto box = [&](float from, float to) {
    return Box{{from * kKink, kY, -6.0e-5f}, {to * kKink, kY, -5.5e-5f}};
  };
  expectSeen(scene, viewOf({2e-6, kY - 1e-3, 1}, .032, .01), box(.55f, .58f), 32, "in the map");
  expectSeen(scene, viewOf({.032 + 2e-6, kY - 1e-3, 1}, .032, .01), box(.36f, .39f), 32, "at its border");
}

// A wall just beyond the near plane whose mesh has a vertex just before it: a hole.
TEST(MapSlack, AVertexBeforeTheNearPlane) {
  for (int up = 1; up <= 8; ++up) {
    constexpr float kBeyond = 0x1p-23f, kHeight = 5e-3f, kTop = 1.00001f;
    const auto at = [&](float x, float y) {
      return Vec3f(x, y, y > .5f ? -(kTop + kBeyond) : -(1 + kBeyond));
    };
    const Scene scene = sceneOf({at(-.5f, 0),
                                 at(0, 0),
                                 at(.5f, 0),
                                 at(.5f, 1),
                                 at(0, 1),
                                 at(-.5f, 1),
                                 {0, kHeight, -(1 - static_cast<float>(up) * 0x1p-24f)}},
                                {0, 1, 6, 0, 6, 5, 5, 6, 4, 1, 2, 6, 2, 3, 6, 3, 4, 6});
    const Box box{{-1e-7f, 3 * kHeight, -3.01f}, {1e-7f, 3 * kHeight + 1e-7f, -3}};
    const View view = viewOf({0, 0, 0}, .01, 1);
    if (reaches(scene, view, center(box))) {
      expectSeen(scene, view, box, 512, std::to_string(up).c_str());
    }
  }
}

}  // namespace
}  // namespace sightline
